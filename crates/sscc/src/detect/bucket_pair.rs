//! Tests of a bucket against itself and of two buckets: packets of boxes against packets, down to triangle pairs.

use super::aabb8::{LANES, Lanes, PacketPair, PairsOfLanes};
use super::candidates::Candidates;
use super::narrow_phase::{NarrowPhase, TrianglePairs};
use super::search::{Search, TriangleVertices};
use super::vertex_motion::VertexMotion;
use crate::filter::Relation;

/// The pairs of lanes `(i, j)` with `j < i`, as in [`PacketPair`].
const NOT_LATER: u64 = 0x7f3f_1f0f_0703_0100;

/// A packet, by its bucket and its lane there.
#[derive(Clone, Copy)]
struct BucketLane {
    bucket: u32,
    lane: usize,
}

impl<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, 1, E, M, N> {
    /// Tests a bucket against itself.
    pub(crate) fn test_bucket(&mut self, bucket: u32) {
        self.sides[0].open_bucket(bucket);
        let volumes = &*self.sides[0].volumes;
        let count = volumes.layout.buckets.packets(bucket).len();
        self.state.counters.box_tests += (LANES * count) as u64;
        let packets = volumes.packets(bucket);
        let masked =
            with_mutant!(NOT_LATER, PacketNotTestedAgainstItself, NOT_LATER << 1 | 0x0101_0101_0101_0101);
        let pair = PacketPair { first: packets, second: packets, rows: (1 << count) - 1, masked };
        self.state.candidates.share_no_vertex =
            with_mutant!(false, SharedVerticesOfLastBuckets, self.state.candidates.share_no_vertex);
        for (i, j) in PairsOfLanes(pair.overlaps(volumes.instructions).pairs) {
            let [first, second] = [i, j].map(|lane| BucketLane { bucket, lane });
            self.test_packet_pair(first, second);
        }
        self.test_candidates();
    }
}

impl<const SIDES: usize, const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, SIDES, E, M, N> {
    /// Whether the triangles in two slots never count.
    #[inline]
    fn are_adjacent(&self, slots: [usize; 2]) -> bool {
        let side = &self.sides[0];
        let buckets = &side.volumes.layout.buckets;
        if side.context.filter.is_adjacency_alone() {
            return buckets.has_shared_vertex(slots);
        }
        let [a, b] = slots.map(|slot| buckets.triangle(slot));
        side.context.filter.relation(a, b) == Relation::Adjacent
    }

    /// Tests two buckets.
    pub(crate) fn test_bucket_pair(&mut self, (n, m): (u32, u32)) {
        self.state.counters.opened += 1;
        // Masks of adjacent pairs are stored with the packet of the lower number.
        let (n, m) = if SIDES == 1 { (n.min(m), n.max(m)) } else { (n, m) };
        self.sides[0].open_bucket(n);
        self.sides[Self::LAST].open_bucket(m);
        let [first, last] = [(0, n), (Self::LAST, m)].map(|(side, bucket)| {
            let volumes = &*self.sides[side].volumes;
            (volumes.node(volumes.layout.buckets.node(bucket)), volumes.packets(bucket))
        });
        self.state.counters.box_tests += 1;
        if !first.0.overlaps(last.0) {
            self.state.loose_pairs += 1;
            return;
        }
        self.state.counters.box_tests += LANES as u64;
        let rows = first.1.overlapping(last.0).0;
        let pair = PacketPair { first: first.1, second: last.1, rows, masked: 0 };
        let volumes = &*self.sides[0].volumes;
        let overlaps = pair.overlaps(volumes.instructions);
        self.state.counters.box_tests += LANES as u64 * u64::from(overlaps.rows);
        let share_no_vertex = SIDES == 2
            || self.sides[0].context.filter.groups().is_none()
                && !volumes.layout.buckets.can_share_vertex(n, m);
        self.state.candidates.share_no_vertex = share_no_vertex;
        for (i, j) in PairsOfLanes(overlaps.pairs) {
            let first = BucketLane { bucket: n, lane: i };
            let second = BucketLane { bucket: m, lane: j };
            self.test_packet_pair(first, second);
        }
        if with_mutant!(true, LastCandidatesForgotten, false) {
            self.test_candidates();
        }
    }

    /// Tests two packets whose boxes overlap (with one side, the second is not before the first), or one packet against itself.
    /// The last pairs of triangles remain candidates.
    #[inline]
    fn test_packet_pair(&mut self, x: BucketLane, y: BucketLane) {
        let [first, last] = [&*self.sides[0].volumes, &*self.sides[Self::LAST].volumes];
        let buckets = [&first.layout.buckets, &last.layout.buckets];
        let packets =
            [buckets[0].packets(x.bucket).start + x.lane, buckets[1].packets(y.bucket).start + y.lane];
        let (masked, has_adjacent) = if self.state.candidates.share_no_vertex {
            (0, true)
        } else {
            buckets[0].masked_pairs(packets[0], packets[1])
        };
        let starts = [buckets[0].slots(packets[0]).start, buckets[1].slots(packets[1]).start];
        // Most triangles of a packet are separate from the whole other packet.
        let outer = [(first.packets(x.bucket), x.lane), (last.packets(y.bucket), y.lane)];
        let triangles = [first.triangles(packets[0]), last.triangles(packets[1])];
        let pair = PacketPair { first: triangles[0], second: triangles[1], rows: 0, masked };
        let overlaps = pair.overlaps_within(first.instructions, outer);
        self.state.counters.box_tests += LANES as u64 * u64::from(2 + overlaps.rows);
        for (row, column) in PairsOfLanes(overlaps.pairs) {
            let slots = [starts[0] + row, starts[1] + column];
            if !has_adjacent && self.are_adjacent(slots) {
                continue;
            }
            let [first, last] = [&*self.sides[0].volumes, &*self.sides[Self::LAST].volumes];
            let corners = [first.mapped_corners(x.bucket, slots[0]), last.mapped_corners(y.bucket, slots[1])];
            if self.state.candidates.push(slots, corners) {
                self.test_candidates();
            }
        }
    }

    /// Tests all candidates, and removes them.
    fn test_candidates(&mut self) {
        if self.state.candidates.count == 0 {
            return;
        }
        let [first, last] = [&*self.sides[0].volumes, &*self.sides[Self::LAST].volumes];
        let errors = [first.corner_error(), last.corner_error()];
        let candidates = &mut self.state.candidates;
        let count = candidates.take();
        let pairs = TrianglePairs {
            positions: [first.mapped_positions(), last.mapped_positions()],
            corners: &candidates.corners,
            count,
            error: with_mutant!(errors[0].max(errors[1]), ErrorOfFirstShape, errors[0]),
        };
        let open = Lanes(!pairs.separated(first.instructions) & ((1 << count) - 1));
        for lane in open {
            let slots = candidates.slots[lane as usize];
            first.prefetch_corners(first.layout.buckets.corners()[slots[0]]);
            last.prefetch_corners(last.layout.buckets.corners()[slots[1]]);
        }
        for lane in open {
            let Candidates { slots, share_no_vertex, .. } = &self.state.candidates;
            let (slots, share_no_vertex) = (slots[lane as usize], *share_no_vertex);
            let [a, b] = [(0, slots[0]), (Self::LAST, slots[1])].map(|(side, slot)| {
                let buckets = &self.sides[side].volumes.layout.buckets;
                TriangleVertices { triangle: buckets.triangle(slot), vertices: buckets.corners()[slot] }
            });
            let relation = if share_no_vertex {
                Relation::NonAdjacent
            } else {
                self.sides[0].context.filter.relation(a.triangle, b.triangle)
            };
            if relation != Relation::Adjacent {
                self.test_related_triangles(relation, a, b);
            }
        }
    }
}
