//! Tests of a bucket against itself and of two buckets: packets of boxes against packets, down to triangle pairs.

use super::aabb8::{LANES, PacketPair, PairsOfLanes};
use super::broad_phase::{BroadPhase, TriangleVertices};
use super::context::Context;
use super::narrow_phase::NarrowPhase;
use super::node_volumes::BucketSlot;
use super::vertex_motion::VertexMotion;
use crate::filter::Relation;

/// The pairs of lanes `(i, j)` with `j < i`, as in [`PacketPair`].
const NOT_LATER: u64 = 0x7f3f_1f0f_0703_0100;

/// A packet: its bucket and its lane there.
#[derive(Clone, Copy)]
struct BucketLane {
    bucket: u32,
    lane: usize,
}

impl<const E: usize> BroadPhase<E> {
    /// Whether the triangles in two slots never count.
    #[inline]
    fn are_adjacent(&self, context: &Context, slots: [usize; 2]) -> bool {
        let buckets = &self.volumes.layout.buckets;
        if context.filter.is_adjacency_alone() {
            return buckets.has_shared_vertex(slots);
        }
        let [a, b] = slots.map(|slot| buckets.triangle(slot));
        context.filter.relation(a, b) == Relation::Adjacent
    }

    /// Tests a bucket against itself.
    pub(crate) fn test_bucket<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        bucket: u32,
        motion: &M,
        narrow: &mut N,
    ) {
        self.volumes.open_bucket(bucket, motion);
        let count = self.volumes.layout.buckets.packets(bucket).len();
        self.counters.box_tests += (LANES * count) as u64;
        let packets = self.volumes.packets(bucket);
        let masked =
            right_or!(NOT_LATER, PacketNotTestedAgainstItself, NOT_LATER << 1 | 0x0101_0101_0101_0101);
        let pair = PacketPair { first: packets, second: packets, rows: (1 << count) - 1, masked };
        for (i, j) in PairsOfLanes(pair.overlaps(self.volumes.instructions).pairs) {
            let [first, second] = [i, j].map(|lane| BucketLane { bucket, lane });
            self.test_packet_pair(context, first, second, false, motion, narrow);
        }
    }

    /// Tests two buckets.
    pub(crate) fn test_bucket_pair<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        (n, m): (u32, u32),
        motion: &M,
        narrow: &mut N,
    ) {
        self.counters.opened += 1;
        // Masks of adjacency are stored with the packet of the lower number.
        let (n, m) = (n.min(m), n.max(m));
        [n, m].iter().for_each(|bucket| self.volumes.prefetch_bucket(*bucket));
        [n, m].iter().for_each(|bucket| self.volumes.open_bucket(*bucket, motion));
        let [x, y] = [n, m].map(|bucket| *self.volumes.node(self.volumes.layout.buckets.node(bucket)));
        self.counters.box_tests += 1;
        if !x.overlaps(&y) {
            self.loose_pairs += 1;
            return;
        }
        self.counters.box_tests += LANES as u64;
        let [first, second] = [n, m].map(|bucket| self.volumes.packets(bucket));
        let pair = PacketPair { first, second, rows: first.overlapping(&y).0, masked: 0 };
        let overlaps = pair.overlaps(self.volumes.instructions);
        self.counters.box_tests += LANES as u64 * u64::from(overlaps.rows);
        let share_no_vertex =
            context.filter.groups().is_none() && !self.volumes.layout.buckets.can_share_vertex(n, m);
        for (i, j) in PairsOfLanes(overlaps.pairs) {
            let first = BucketLane { bucket: n, lane: i };
            let second = BucketLane { bucket: m, lane: j };
            self.test_packet_pair(context, first, second, share_no_vertex, motion, narrow);
        }
    }

    /// Tests two packets whose boxes overlap, the second not before the first, or one packet against itself.
    /// `share_no_vertex`: each two of their triangles count. Then neither masks nor vertex classes are read, which are far apart
    /// in memory.
    #[inline]
    fn test_packet_pair<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        x: BucketLane,
        y: BucketLane,
        share_no_vertex: bool,
        motion: &M,
        narrow: &mut N,
    ) {
        let buckets = &self.volumes.layout.buckets;
        let [first, second] = [x, y].map(|packet| buckets.packets(packet.bucket).start + packet.lane);
        let (masked, has_adjacent) =
            if share_no_vertex { (0, true) } else { buckets.masked_pairs(first, second) };
        let (start_x, start_y) = (buckets.slots(first).start, buckets.slots(second).start);
        // Most triangles of a packet stay clear of the whole other packet.
        let outer = [x, y].map(|packet| (self.volumes.packets(packet.bucket), packet.lane));
        let [first, second] = [first, second].map(|packet| self.volumes.triangles(packet));
        let overlaps =
            PacketPair { first, second, rows: 0, masked }.overlaps_within(self.volumes.instructions, outer);
        self.counters.box_tests += LANES as u64 * u64::from(2 + overlaps.rows);
        let mut open = 0;
        for (row, column) in PairsOfLanes(overlaps.pairs) {
            let slots = [start_x + row, start_y + column];
            if !has_adjacent && self.are_adjacent(context, slots) {
                continue;
            }
            let a = BucketSlot { bucket: x.bucket, slot: slots[0] };
            let b = BucketSlot { bucket: y.bucket, slot: slots[1] };
            if self.volumes.are_separated(a, b) {
                continue;
            }
            let corners = self.volumes.layout.buckets.corners();
            slots.iter().for_each(|slot| self.volumes.prefetch_corners(corners[*slot]));
            open |= 1 << (LANES * row + column);
        }
        for (row, column) in PairsOfLanes(open) {
            let slots = [start_x + row, start_y + column];
            let buckets = &self.volumes.layout.buckets;
            let [a, b] = slots.map(|slot| TriangleVertices {
                triangle: buckets.triangle(slot),
                vertices: buckets.corners()[slot],
            });
            if share_no_vertex {
                self.test_related_triangles(context, Relation::NonAdjacent, a, b, motion, narrow);
            } else {
                self.test_triangles(context, a, b, motion, narrow);
            }
        }
    }
}
