//! The traversal of two hierarchies: colliding pairs of two meshes.

use super::aabb8::LANES;
use super::broad_phase::Counters;
use super::context::Context;
use super::narrow_phase::NarrowPhase;
use super::node_volumes::{BucketSlot, NodeVolumes, are_slots_separated};
use super::vertex_motion::VertexMotion;
use crate::Error;
use crate::filter::Relation;
use crate::hierarchy::NodePair;

/// Visits between two checks whether the search was cancelled.
const VISITS_PER_CHECK: u64 = 256;

/// One of two meshes: its context, its volumes, which have begun a search in the same frame as the other's, and its motion.
pub(crate) struct Side<'s, const E: usize, M> {
    pub(crate) context: &'s Context,
    pub(crate) volumes: &'s mut NodeVolumes<E>,
    pub(crate) motion: &'s M,
}

impl<const E: usize, M: VertexMotion<E>> Side<'_, E, M> {
    fn bucket(&self, node: u32) -> Option<u32> {
        self.volumes.layout.buckets.of_node(node)
    }

    fn first_child(&self, node: u32) -> u32 {
        self.context.hierarchy.nodes()[node as usize].first_child
    }

    fn open(&mut self, node: u32) {
        self.volumes.open_node(&self.context.hierarchy, node, self.motion);
    }
}

/// Finds all hits between two meshes, in pairs (triangle of x, triangle of y), not sorted. Every triangle of x is paired with
/// every one of y: neither contact filter applies.
///
/// # Errors
/// When the token of the first context cancels.
pub(crate) fn traverse_two_meshes<
    const E: usize,
    X: VertexMotion<E>,
    Y: VertexMotion<E>,
    N: NarrowPhase<E>,
>(
    x: &mut Side<'_, E, X>,
    y: &mut Side<'_, E, Y>,
    stack: &mut Vec<NodePair>,
    counters: &mut Counters,
    narrow: &mut N,
) -> Result<(), Error> {
    stack.clear();
    x.volumes.update_node(0, x.motion);
    y.volumes.update_node(0, y.motion);
    counters.box_tests += 1;
    if x.volumes.node(0).overlaps(y.volumes.node(0)) {
        stack.push((0, 0));
    }
    let mut next_check = VISITS_PER_CHECK;
    while let Some((n, m)) = stack.pop() {
        counters.opened += 1;
        // One pair of buckets may have thousands of triangle tests.
        let visits = counters.opened + counters.triangle_tests;
        if visits >= next_check {
            next_check = visits + VISITS_PER_CHECK;
            if x.context.is_cancelled() {
                return Err(Error::Cancelled);
            }
        }
        match [x.bucket(n), y.bucket(m)] {
            [Some(a), Some(b)] => {
                if narrow.hits().note_if_full() {
                    break;
                }
                test_buckets(x, a, y, b, counters, narrow);
            }
            // A node larger than a bucket is opened.
            [None, Some(_)] => {
                x.open(n);
                let first_child = x.first_child(n);
                counters.box_tests += LANES as u64;
                let open = x.volumes.children(n).overlapping_of_four(y.volumes.node(m));
                stack.extend(open.map(|i| (first_child + i, m)));
            }
            [Some(_), None] => {
                y.open(m);
                let first_child = y.first_child(m);
                counters.box_tests += LANES as u64;
                let open = y.volumes.children(m).overlapping_of_four(x.volumes.node(n));
                stack.extend(open.map(|j| (n, first_child + j)));
            }
            [None, None] => {
                x.open(n);
                y.open(m);
                let first = [x.first_child(n), y.first_child(m)];
                counters.box_tests += LANES as u64;
                for i in x.volumes.children(n).overlapping_of_four(y.volumes.node(m)) {
                    counters.box_tests += LANES as u64;
                    let open =
                        y.volumes.children(m).overlapping_lane_of_four(x.volumes.children(n), i as usize);
                    stack.extend(open.map(|j| (first[0] + i, first[1] + j)));
                }
            }
        }
    }
    Ok(())
}

/// Tests two buckets whose boxes overlap.
fn test_buckets<const E: usize, X: VertexMotion<E>, Y: VertexMotion<E>, N: NarrowPhase<E>>(
    x: &mut Side<'_, E, X>,
    a: u32,
    y: &mut Side<'_, E, Y>,
    b: u32,
    counters: &mut Counters,
    narrow: &mut N,
) {
    let (x_layout, y_layout) =
        (std::sync::Arc::clone(&x.volumes.layout), std::sync::Arc::clone(&y.volumes.layout));
    let [x_buckets, y_buckets] = [&x_layout.buckets, &y_layout.buckets];
    let (x_node, y_node) = (x_buckets.node(a), y_buckets.node(b));
    // An open bucket has a tighter AABB, which may save opening the other one. Their AABBs may have become tighter since they
    // were put on the stack, too.
    counters.box_tests += 1;
    if !x.volumes.node(x_node).overlaps(y.volumes.node(y_node)) {
        return;
    }
    if !x.volumes.is_bucket_open(a) {
        x.volumes.open_bucket(a, x.motion);
        counters.box_tests += 1;
        if !x.volumes.node(x_node).overlaps(y.volumes.node(y_node)) {
            return;
        }
    }
    if !y.volumes.is_bucket_open(b) {
        y.volumes.open_bucket(b, y.motion);
        counters.box_tests += 1;
        if !x.volumes.node(x_node).overlaps(y.volumes.node(y_node)) {
            return;
        }
    }
    let y_box = *y.volumes.node(y_node);
    counters.box_tests += LANES as u64;
    for i in x.volumes.packets(a).overlapping(&y_box) {
        counters.box_tests += LANES as u64;
        let x_packet = x_buckets.packets(a).start + i as usize;
        for j in y.volumes.packets(b).overlapping_lane(x.volumes.packets(a), i as usize) {
            counters.box_tests += LANES as u64;
            let y_packet = y_buckets.packets(b).start + j as usize;
            // Most triangles of a packet stay clear of the whole other packet.
            for row in x.volumes.triangles(x_packet).overlapping_lane(y.volumes.packets(b), j as usize) {
                counters.box_tests += LANES as u64;
                let x_triangles = x.volumes.triangles(x_packet);
                for column in y.volumes.triangles(y_packet).overlapping_lane(x_triangles, row as usize) {
                    let slots = [
                        BucketSlot { bucket: a, slot: x_buckets.slots(x_packet).start + row as usize },
                        BucketSlot { bucket: b, slot: y_buckets.slots(y_packet).start + column as usize },
                    ];
                    if are_slots_separated((x.volumes, slots[0]), (y.volumes, slots[1])) {
                        continue;
                    }
                    if narrow.hits().note_if_full() {
                        return;
                    }
                    counters.triangle_tests += 1;
                    let vertices = [x_buckets.corners()[slots[0].slot], y_buckets.corners()[slots[1].slot]];
                    x.volumes.move_corners(vertices[0], x.motion);
                    y.volumes.move_corners(vertices[1], y.motion);
                    let corners = [x.volumes.corners(vertices[0]), y.volumes.corners(vertices[1])];
                    let pair = (x_buckets.triangle(slots[0].slot), y_buckets.triangle(slots[1].slot));
                    let hit =
                        N::test(&x.context.filter, Relation::NonAdjacent, pair, &corners[0], &corners[1]);
                    narrow.hits().list.extend(hit);
                }
            }
        }
    }
}
