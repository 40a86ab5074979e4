//! The traversal of the bounding volume test tree (BVTT): which nodes and node pairs are opened. This one uses no
//! certificates, but normal cones where the method has them. `query/` has the traversals with certificates; they use
//! the same tests.
//!
//! One box is always compared with up to eight. The stack holds nodes `(n, n)`, and pairs `(n, m)` of nodes without
//! common triangles whose boxes overlap.

use super::aabb8::LANES;
use super::broad_phase::BroadPhase;
use super::context::Context;
use super::narrow_phase::NarrowPhase;
use super::vertex_motion::VertexMotion;
use crate::hierarchy::NodePair;

impl<const E: usize> BroadPhase<E> {
    /// Finds all hits between two nodes, or within one, but exceptions; for nodes within a bucket, those of the bucket.
    pub(crate) fn traverse<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        start: NodePair,
        motion: &M,
        narrow: &mut N,
    ) {
        self.begin_traversal(start, motion);
        while let Some((n, m)) = self.next_visit(context, narrow) {
            if n != m {
                self.visit_node_pair(context, (n, m), motion, narrow);
            } else if !self.is_culled_by_cones(n) && self.visit_node(context, n, motion, narrow) {
                let node = context.hierarchy.nodes()[n as usize];
                node.child_pairs().for_each(|pair| self.push_overlapping(n, node.first_child, pair));
            }
        }
        self.test_deferred_bucket_pair(context, motion, narrow);
    }

    /// Puts a node `(n, n)` or a node pair on the empty stack.
    pub(crate) fn begin_traversal<M: VertexMotion<E>>(&mut self, (n, m): NodePair, motion: &M) {
        let buckets = &self.volumes.layout.buckets;
        let start = [n, m].map(|n| buckets.of_node(n).map_or(n, |bucket| buckets.node(bucket)));
        start.iter().for_each(|n| self.volumes.update_node(*n, motion));
        self.stack.clear();
        self.stack.push(start.into());
    }

    /// Takes the next node or node pair from the stack; none at the end of the search.
    #[inline]
    pub(crate) fn next_visit<N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        narrow: &mut N,
    ) -> Option<NodePair> {
        let next = self.stack.pop()?;
        self.count_visit(context, narrow).then_some(next)
    }

    /// Whether the normal cones of the method, if it has any, cull a node.
    fn is_culled_by_cones(&mut self, n: u32) -> bool {
        self.cones.as_mut().is_some_and(|cones| cones.cull(n, &self.volumes))
    }

    /// Opens a node (Algorithm 1, lines 1 to 14): tests a bucket, puts the children of a larger node on the stack. True if
    /// the pairs of its children remain to be tested ([`BroadPhase::push_overlapping`]).
    #[inline]
    pub(crate) fn visit_node<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        n: u32,
        motion: &M,
        narrow: &mut N,
    ) -> bool {
        self.counters.opened += 1;
        if let Some(bucket) = self.volumes.layout.buckets.of_node(n) {
            self.test_bucket(context, bucket, motion, narrow);
            return false;
        }
        self.volumes.open_node(&context.hierarchy, n, motion);
        let node = context.hierarchy.nodes()[n as usize];
        self.stack.extend(node.children().map(|child| (child, child)));
        true
    }

    /// Puts a pair of children of the open node n on the stack if their boxes overlap.
    #[inline]
    pub(crate) fn push_overlapping(&mut self, n: u32, first_child: u32, (a, b): NodePair) {
        self.counters.box_tests += 1;
        let lanes = self.volumes.children(n).overlapping_of_four(self.volumes.node(a));
        if lanes.0 >> (b - first_child) & 1 != 0 {
            self.stack.push((a, b));
        }
    }

    /// Opens two nodes whose boxes overlap (Algorithm 1, lines 15 to 30), both at once, down to buckets.
    #[inline]
    pub(crate) fn visit_node_pair<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        (n, m): NodePair,
        motion: &M,
        narrow: &mut N,
    ) {
        let first_child = |n: u32| context.hierarchy.nodes()[n as usize].first_child;
        // A bucket comes second.
        let [n, m] = match [n, m].map(|n| self.volumes.layout.buckets.of_node(n)) {
            [Some(a), Some(b)] => return self.defer_bucket_pair(context, (a, b), motion, narrow),
            [Some(_), None] => [m, n],
            [None, _] => [n, m],
        };
        self.counters.opened += 1;
        self.volumes.open_node(&context.hierarchy, n, motion);
        self.counters.box_tests += LANES as u64;
        let open = self.volumes.children(n).overlapping_of_four(self.volumes.node(m));
        if self.volumes.layout.buckets.of_node(m).is_some() {
            self.stack.extend(open.map(|i| (first_child(n) + i, m)));
            return;
        }
        self.volumes.open_node(&context.hierarchy, m, motion);
        for i in open {
            self.counters.box_tests += LANES as u64;
            let open =
                self.volumes.children(m).overlapping_lane_of_four(self.volumes.children(n), i as usize);
            self.stack.extend(open.map(|j| (first_child(n) + i, first_child(m) + j)));
        }
    }
}
