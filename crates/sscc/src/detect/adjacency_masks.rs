//! Bit masks of the adjacent triangle pairs of two packets. These pairs never count.

use super::aabb8::LANES;
use crate::filter::{PairFilter, Relation};

/// Vertices with more triangles have no masks, since the number of pairs grows with the square. For their pairs the
/// narrow phase uses [`PairFilter`].
const MAX_VERTEX_TRIANGLES: usize = 24;

/// For each two packets with adjacent triangles, a mask of the pairs that never count. Nearly all triangles whose AABBs
/// overlap share a vertex, so masks avoid most calls of the narrow phase (docs/notes/broad-phase.md#packets).
#[derive(Default)]
pub(crate) struct AdjacencyMasks {
    /// For each packet the start of its masks, then the end of the last packet's.
    starts: Vec<u32>,
    /// For each packet itself and the later packets with triangles adjacent to its own at a vertex of few triangles, ascending,
    /// each with its mask.
    masks: Vec<PacketMask>,
    /// For each bucket the start of its neighbours, then the end of the last bucket's.
    neighbour_starts: Vec<u32>,
    /// For each bucket the buckets after it that share a vertex class of few triangles with it, ascending.
    neighbours: Vec<u32>,
    /// For each bucket whether it has a vertex class of many triangles. Two such buckets may share the class.
    has_large_class: Vec<bool>,
}

/// The triangles around each vertex class, as `8 packet + lane`.
struct TrianglesAround {
    /// For each class the start of its triangles, then the end of the last class's.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl TrianglesAround {
    fn new(slots: &[u32], triangles: &[u32], filter: &PairFilter) -> Self {
        let mut starts = vec![0_u32; filter.class_count() + 1];
        // A degenerate triangle is counted once.
        let classes = |t: u32| {
            let [a, b, c] = filter.vertex_classes(t);
            [Some(a), (b != a).then_some(b), (c != a && c != b).then_some(c)].into_iter().flatten()
        };
        triangles.iter().flat_map(|&t| classes(t)).for_each(|class| starts[class as usize + 1] += 1);
        (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
        let mut next = starts.clone();
        let mut sorted = vec![0; starts.last().map_or(0, |end| *end as usize)];
        for packet in 0..slots.len() - 1 {
            for (lane, slot) in (slots[packet]..slots[packet + 1]).enumerate() {
                for class in classes(triangles[slot as usize]) {
                    sorted[next[class as usize] as usize] = (LANES * packet + lane) as u32;
                    next[class as usize] += 1;
                }
            }
        }
        Self { starts, triangles: sorted }
    }

    fn of_class(&self, class: u32) -> &[u32] {
        let [start, end] = [class, class + 1].map(|class| self.starts[class as usize] as usize);
        &self.triangles[start..end]
    }
}

/// The masked pairs of one packet with another one.
#[derive(Clone, Copy)]
struct PacketMask {
    other: u32,
    /// Bit `8 i + j` for lane i of the first and lane j of the other packet.
    pairs: u64,
}

/// Bits `8 i + j` with `j <= i`.
const NOT_AFTER: u64 = 0xff7f_3f1f_0f07_0301;

impl AdjacencyMasks {
    /// Computes the masks of triangles in packets: `packets[b]..packets[b + 1]` are the packets of bucket b,
    /// `slots[p]..slots[p + 1]` the slots of packet p.
    pub(crate) fn new(packets: &[u32], slots: &[u32], triangles: &[u32], filter: &PairFilter) -> Self {
        let members = |packet: usize| &triangles[slots[packet] as usize..slots[packet + 1] as usize];
        let around = TrianglesAround::new(slots, triangles, filter);
        let mut all = Self { starts: vec![0], neighbour_starts: vec![0], ..Self::default() };
        let (mut found, mut neighbours): (Vec<PacketMask>, Vec<u32>) = (Vec::new(), Vec::new());
        for bucket in packets.windows(2) {
            let mut has_large_class = false;
            for first in bucket[0] as usize..bucket[1] as usize {
                found.push(PacketMask { other: first as u32, pairs: NOT_AFTER });
                for (i, &t) in members(first).iter().enumerate() {
                    let around = filter.vertex_classes(t).map(|class| around.of_class(class));
                    has_large_class |= around.iter().any(|all| all.len() > MAX_VERTEX_TRIANGLES);
                    let of_few = around.into_iter().filter(|all| all.len() <= MAX_VERTEX_TRIANGLES);
                    for &other in of_few.flatten() {
                        let (second, j) = (other as usize / LANES, other as usize % LANES);
                        if second >= bucket[1] as usize {
                            neighbours.push(second as u32);
                        }
                        if second >= first && filter.relation(t, members(second)[j]) == Relation::Adjacent {
                            found.push(PacketMask { other: second as u32, pairs: 1 << (LANES * i + j) });
                        }
                    }
                }
                found.sort_unstable_by_key(|mask| mask.other);
                let merged = |same: &[PacketMask]| PacketMask {
                    other: same[0].other,
                    pairs: same.iter().fold(0, |all, mask| all | mask.pairs),
                };
                all.masks.extend(found.chunk_by(|x, y| x.other == y.other).map(merged));
                all.starts.push(all.masks.len() as u32);
                found.clear();
            }
            let bucket_of = |packet: &u32| packets.partition_point(|start| start <= packet) as u32 - 1;
            neighbours.sort_unstable();
            neighbours.dedup();
            neighbours.iter_mut().for_each(|packet| *packet = bucket_of(packet));
            neighbours.dedup();
            all.neighbours.append(&mut neighbours);
            all.neighbour_starts.push(all.neighbours.len() as u32);
            all.has_large_class.push(has_large_class);
        }
        all
    }

    /// Whether triangles of two buckets, the first before the second, may share a vertex class.
    #[inline]
    pub(crate) fn can_share_vertex(&self, first: u32, second: u32) -> bool {
        let [start, end] = [0, 1].map(|i| self.neighbour_starts[first as usize + i] as usize);
        let have_large_class = self.has_large_class[first as usize] && self.has_large_class[second as usize];
        self.neighbours[start..end].contains(&second)
            || with_mutant!(have_large_class, LargeClassForgotten, false)
    }

    /// Returns the masked pairs of two packets without those of adjacent triangles: for one packet with itself the pairs with
    /// `j <= i`.
    #[inline]
    pub(crate) fn masked_without(first: usize, second: usize) -> u64 {
        if first == second { NOT_AFTER } else { 0 }
    }

    /// Returns the pairs of two packets, the first not after the second, that never count: bit `8 i + j` for lane i of the
    /// first and lane j of the second. For one packet with itself also the pairs with `j <= i`, so that each pair counts once.
    #[inline]
    pub(crate) fn masked_pairs(&self, first: usize, second: usize) -> u64 {
        let all = &self.masks[self.starts[first] as usize..self.starts[first + 1] as usize];
        all.iter().find(|mask| mask.other == second as u32).map_or(0, |mask| mask.pairs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ContactFilter;

    /// The mesh is a strip of triangles, and a fan of many triangles around one vertex, in buckets of one to three packets of
    /// few triangles.
    #[test]
    fn buckets_that_share_a_vertex_are_neighbours() {
        let strip = (0..90).map(|i| [i, i + 1, i + 2]);
        let fan = (0..40).map(|i| [200, 201 + i, 202 + i]);
        let faces: Vec<[u32; 3]> = strip.chain(fan).collect();
        let filter = PairFilter::with_classes(&faces, None, &ContactFilter::default());
        // The order has steps of seven triangles, so that neighbours in the mesh are far apart in it.
        let triangles: Vec<u32> = (0..130).map(|i| i * 7 % 130).collect();
        let mut slots = vec![0];
        while *slots.last().unwrap() < 130 {
            slots.push((slots.last().unwrap() + 1 + slots.len() as u32 % 4).min(130));
        }
        let mut packets = vec![0];
        while *packets.last().unwrap() < slots.len() as u32 - 1 {
            packets
                .push((packets.last().unwrap() + 1 + packets.len() as u32 % 3).min(slots.len() as u32 - 1));
        }
        let masks = AdjacencyMasks::new(&packets, &slots, &triangles, &filter);
        let of_bucket = |b: usize| {
            &triangles[slots[packets[b] as usize] as usize..slots[packets[b + 1] as usize] as usize]
        };
        let (mut neighbours, mut others) = (0, 0);
        for second in 0..packets.len() - 1 {
            for first in 0..second {
                let shares = |a: &u32| {
                    of_bucket(second).iter().any(|b| filter.relation(*a, *b) != Relation::NonAdjacent)
                };
                let is_neighbour = of_bucket(first).iter().any(shares);
                assert!(
                    masks.can_share_vertex(first as u32, second as u32) || !is_neighbour,
                    "{first} {second}"
                );
                neighbours += i32::from(is_neighbour);
                others += i32::from(!masks.can_share_vertex(first as u32, second as u32));
            }
        }
        assert!(neighbours > 20 && others > 20, "{neighbours} {others}");
    }

    #[test]
    fn vertices_of_any_number_of_triangles_are_shared() {
        for count in 22..=27_u32 {
            let faces: Vec<[u32; 3]> = (0..count).map(|i| [0, 1 + 2 * i, 2 + 2 * i]).collect();
            let filter = PairFilter::with_classes(&faces, None, &ContactFilter::default());
            let slots: Vec<u32> = (0..=count.div_ceil(8)).map(|p| (8 * p).min(count)).collect();
            let triangles: Vec<u32> = (0..count).collect();
            let masks = AdjacencyMasks::new(&[0, 1, count.div_ceil(8)], &slots, &triangles, &filter);
            assert!(masks.can_share_vertex(0, 1), "{count}");
        }
    }
}
