//! The traversal of the bounding volume test tree (BVTT), which opens nodes and node pairs whose AABBs overlap. This one
//! uses no certificates, but the normal cones of the method, if any. The traversals with certificates are in `query/`; they
//! use the same tests.
//!
//! Each comparison is that of one box with up to eight boxes. The stack contains nodes `(n, n)` of one side, and pairs `(n, m)` of
//! nodes without common triangles whose boxes overlap.

use super::aabb8::LANES;
use super::narrow_phase::NarrowPhase;
use super::search::{Search, SearchState, Side};
use super::vertex_motion::VertexMotion;
use crate::Error;
use crate::filter::GroupsBetween;
use crate::hierarchy::NodePair;

impl<const SIDES: usize, const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, SIDES, E, M, N> {
    /// Takes the next node or node pair from the stack; `None` at the end of the search.
    #[inline]
    pub(crate) fn next_visit(&mut self) -> Option<NodePair> {
        let next = self.state.stack.pop()?;
        self.count_visit().then_some(next)
    }

    /// Opens two nodes whose boxes overlap (Algorithm 1, lines 15 to 30): both at once if neither is a bucket; tests two buckets.
    #[inline]
    pub(crate) fn visit_node_pair(&mut self, (n, m): NodePair) {
        let buckets = [self.sides[0].bucket(n), self.sides[Self::LAST].bucket(m)];
        if let [Some(a), Some(b)] = buckets {
            return self.test_bucket_pair((a, b));
        }
        self.state.counters.opened += 1;
        self.state.counters.box_tests += LANES as u64;
        // A bucket is opened only if the other node is a bucket, too.
        if buckets[0].is_some() {
            self.sides[Self::LAST].open_node(m);
            let first = self.sides[Self::LAST].first_child(m);
            let children = self.sides[Self::LAST].volumes.children(m);
            let open = children.overlapping_of_four(self.sides[0].volumes.node(n));
            self.state.stack.extend(open.map(|j| (n, first + j)));
            return;
        }
        self.sides[0].open_node(n);
        let first = self.sides[0].first_child(n);
        let children = self.sides[0].volumes.children(n);
        let open = children.overlapping_of_four(self.sides[Self::LAST].volumes.node(m));
        if buckets[1].is_some() {
            self.state.stack.extend(open.map(|i| (first + i, m)));
            return;
        }
        self.sides[Self::LAST].open_node(m);
        let of_last = self.sides[Self::LAST].first_child(m);
        for i in open {
            self.state.counters.box_tests += LANES as u64;
            let children = self.sides[Self::LAST].volumes.children(m);
            let open = children.overlapping_lane_of_four(self.sides[0].volumes.children(n), i as usize);
            self.state.stack.extend(open.map(|j| (first + i, of_last + j)));
        }
    }
}

impl<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, 1, E, M, N> {
    /// Finds all hits between two nodes, or within one, except exceptions; for nodes within a bucket, those of the bucket.
    pub(crate) fn traverse(&mut self, start: NodePair) {
        self.begin_traversal(start);
        while let Some((n, m)) = self.next_visit() {
            if n != m {
                self.visit_node_pair((n, m));
            } else if !self.is_culled_by_cones(n) && self.visit_node(n) {
                let node = self.sides[0].context.hierarchy.nodes()[n as usize];
                node.child_pairs().for_each(|pair| self.push_overlapping(n, node.first_child, pair));
            }
        }
    }

    /// Clears the stack, and pushes a node `(n, n)` or a node pair.
    pub(crate) fn begin_traversal(&mut self, (n, m): NodePair) {
        let [side] = &mut self.sides;
        let buckets = &side.volumes.layout.buckets;
        let start = [n, m].map(|n| buckets.of_node(n).map_or(n, |bucket| buckets.node(bucket)));
        start.iter().for_each(|n| side.update_node(*n));
        self.state.stack.clear();
        self.state.stack.push(start.into());
    }

    /// Whether the normal cones of the method, if it has any, cull a node.
    fn is_culled_by_cones(&mut self, n: u32) -> bool {
        self.cones.as_mut().is_some_and(|cones| cones.cull(n, self.sides[0].volumes))
    }

    /// Opens a node (Algorithm 1, lines 1 to 14): tests a bucket, or pushes the children of a larger node on the stack. True if
    /// the pairs of its children remain to be tested ([`Self::push_overlapping`]).
    #[inline]
    pub(crate) fn visit_node(&mut self, n: u32) -> bool {
        self.state.counters.opened += 1;
        if let Some(bucket) = self.sides[0].bucket(n) {
            self.test_bucket(bucket);
            return false;
        }
        self.sides[0].open_node(n);
        let node = self.sides[0].context.hierarchy.nodes()[n as usize];
        self.state.stack.extend(node.children().map(|child| (child, child)));
        true
    }

    /// Pushes a pair of children of the open node n on the stack if their boxes overlap.
    #[inline]
    pub(crate) fn push_overlapping(&mut self, n: u32, first_child: u32, (a, b): NodePair) {
        self.state.counters.box_tests += 1;
        let volumes = &*self.sides[0].volumes;
        let lanes = volumes.children(n).overlapping_of_four(volumes.node(a));
        if lanes.0 >> (b - first_child) & 1 != 0 {
            self.state.stack.push((a, b));
        }
    }
}

impl<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, 2, E, M, N> {
    /// Finds at most `limit` hits between two shapes, as pairs (triangle of the first, triangle of the second), not sorted. The
    /// volumes of both have begun the search, in the same frame. All pairs count, except those that `groups` exclude; the contact
    /// filters do not apply.
    ///
    /// # Errors
    /// When the token of the first context cancels; then there are no hits.
    pub(crate) fn between<'s>(
        sides: [Side<'s, E, M>; 2],
        groups: Option<GroupsBetween<'s>>,
        state: &'s mut SearchState,
        narrow: &'s mut N,
        limit: usize,
    ) -> Result<(), Error> {
        let mut search = Search { groups, ..Search::new(sides, None, state, narrow, limit) };
        search.state.stack.clear();
        search.sides.iter_mut().for_each(|side| side.update_node(0));
        search.state.counters.box_tests += 1;
        if search.overlap((0, 0)) {
            search.state.stack.push((0, 0));
        }
        while let Some(nodes) = search.next_visit() {
            search.visit_node_pair(nodes);
        }
        search.end()
    }
}
