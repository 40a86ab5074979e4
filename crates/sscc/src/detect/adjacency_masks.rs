//! Bit masks of the adjacent triangle pairs of two packets. These pairs never count.

use super::aabb8::LANES;
use crate::filter::{PairFilter, Relation};

/// Vertices with more triangles get no masks, since the number of pairs grows with the square. For these pairs the
/// narrow phase uses [`PairFilter`].
const MAX_VERTEX_TRIANGLES: usize = 24;

/// For each two packets with adjacent triangles, a mask of the pairs that never count. Nearly all triangles whose AABBs
/// overlap share a vertex, so masks avoid most calls of the narrow phase (docs/notes/2026-11-21-packets.md).
#[derive(Default)]
pub(crate) struct AdjacencyMasks {
    /// For each packet the start of its masks, and the end of all.
    starts: Vec<u32>,
    /// For each packet: the packets not before it, ascending, itself first, each with its mask.
    masks: Vec<PacketMask>,
}

/// The triangles around each vertex class, as `8 packet + lane`.
struct TrianglesAround {
    /// For each class its first triangle, and the end of all.
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
    /// Computes the masks of triangles in packets: `slots[p]..slots[p + 1]` are the slots of packet p.
    pub(crate) fn new(slots: &[u32], triangles: &[u32], filter: &PairFilter) -> Self {
        let members = |packet: usize| &triangles[slots[packet] as usize..slots[packet + 1] as usize];
        let around = TrianglesAround::new(slots, triangles, filter);
        let (mut starts, mut masks) = (vec![0], Vec::new());
        let mut found: Vec<PacketMask> = Vec::new();
        for first in 0..slots.len() - 1 {
            found.push(PacketMask { other: first as u32, pairs: NOT_AFTER });
            for (i, &t) in members(first).iter().enumerate() {
                let around = filter.vertex_classes(t).map(|class| around.of_class(class));
                for &other in around.into_iter().filter(|all| all.len() <= MAX_VERTEX_TRIANGLES).flatten() {
                    let (second, j) = (other as usize / LANES, other as usize % LANES);
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
            masks.extend(found.chunk_by(|x, y| x.other == y.other).map(merged));
            starts.push(masks.len() as u32);
            found.clear();
        }
        Self { starts, masks }
    }

    /// The pairs of two packets, without the masks of adjacent triangles: of one packet with itself those with `j <= i`.
    #[inline]
    pub(crate) fn masked_without(first: usize, second: usize) -> u64 {
        if first == second { NOT_AFTER } else { 0 }
    }

    /// The pairs of two packets, the first not after the second, that never count: bit `8 i + j` for lane i of the first
    /// and lane j of the second. Of one packet with itself also those with `j <= i`, so that each pair counts once.
    #[inline]
    pub(crate) fn masked_pairs(&self, first: usize, second: usize) -> u64 {
        let all = &self.masks[self.starts[first] as usize..self.starts[first + 1] as usize];
        all.iter().find(|mask| mask.other == second as u32).map_or(0, |mask| mask.pairs)
    }
}
