//! One search: its sides, its narrow phase, and its counters. It passes triangle pairs with overlapping AABBs to the
//! [`NarrowPhase`], and tests the exceptions.
//!
//! A search has one side, a shape that is tested against itself, or two, shapes that are tested against each other
//! (`SIDES`). Both use the same tests of nodes ([`traversal`](super::traversal)) and of buckets
//! ([`bucket_pair`](super::bucket_pair)). In a node pair `(n, m)` n is of the first side and m of the last.

use super::candidates::Candidates;
use super::context::Context;
use super::narrow_phase::NarrowPhase;
use super::node_volumes::NodeVolumes;
use super::normal_cones::NormalCones;
use super::vertex_motion::VertexMotion;
use crate::Error;
use crate::filter::{GroupsBetween, Relation};
use crate::geometry::Aabb;
use crate::hierarchy::NodePair;

/// Triangle tests between two checks whether the search was cancelled: one test may take a millisecond.
const TESTS_PER_CHECK: u64 = 64;

/// Nodes visited between two checks. A visit takes at most about 10 microseconds, without its triangle tests.
const VISITS_PER_CHECK: u32 = 1024;

/// Boxes of single triangles compared between two checks.
const BOXES_PER_CHECK: u64 = 1024;

/// The cost of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counters {
    /// Nodes and node pairs that were opened.
    pub(crate) opened: u64,
    /// Pairs of boxes compared.
    pub(crate) box_tests: u64,
    /// Pairs of moving hulls compared.
    pub(crate) hull_tests: u64,
    /// Pairs of triangles tested exactly.
    pub(crate) triangle_tests: u64,
}

/// A shape in a search: volumes that have begun it, and the motion of its vertices.
pub(crate) struct Side<'s, const E: usize, M> {
    pub(crate) context: &'s Context,
    pub(crate) volumes: &'s mut NodeVolumes<E>,
    pub(crate) motion: &'s M,
}

impl<const E: usize, M: VertexMotion<E>> Side<'_, E, M> {
    /// Returns the bucket that a node is, or that contains it; `None` for a larger node.
    #[inline]
    pub(crate) fn bucket(&self, node: u32) -> Option<u32> {
        self.volumes.layout.buckets.of_node(node)
    }

    #[inline]
    pub(super) fn first_child(&self, node: u32) -> u32 {
        self.context.hierarchy.nodes()[node as usize].first_child
    }

    #[inline]
    pub(super) fn open_node(&mut self, node: u32) {
        self.volumes.open_node(&self.context.hierarchy, node, self.motion);
    }

    #[inline]
    pub(super) fn open_bucket(&mut self, bucket: u32) {
        self.volumes.open_bucket(bucket, self.motion);
    }

    /// Computes the AABB of a node, unless it is current.
    #[inline]
    pub(crate) fn update_node(&mut self, node: u32) {
        self.volumes.update_node(node, self.motion);
    }

    /// Computes all AABBs from all vertices.
    pub(crate) fn refit(&mut self) {
        self.volumes.refit(&self.context.hierarchy, self.motion);
    }

    /// Moves the corners of a triangle to their exact positions.
    #[inline]
    pub(crate) fn move_corners(&mut self, vertices: [u32; 3]) {
        self.volumes.move_corners(vertices, self.motion);
    }

    /// Returns a triangle of the mesh with the indices of its vertices in the layout.
    pub(crate) fn triangle(&self, triangle: u32) -> TriangleVertices {
        let face = self.context.filter.faces()[triangle as usize];
        TriangleVertices { triangle, vertices: face.map(|v| self.volumes.layout.vertices.index_of(v)) }
    }
}

/// The counters and the memory of a search.
#[derive(Clone, Default)]
pub(crate) struct SearchState {
    /// Nodes `(n, n)` of one side and node pairs `(n, m)` still to be visited: see [`traversal`](super::traversal).
    pub(super) stack: Vec<NodePair>,
    visits: u32,
    /// Tested pairs of buckets whose tight AABBs do not overlap, although the AABBs by which the traversal found them do.
    pub(crate) loose_pairs: usize,
    is_cancelled: bool,
    pub(super) candidates: Candidates,
    pub(crate) counters: Counters,
}

impl SearchState {
    /// Resets the state of the last search.
    #[inline]
    pub(super) fn begin(&mut self) {
        self.is_cancelled = false;
        self.loose_pairs = 0;
        // Pairs remain if the last search panicked.
        self.candidates.count = with_mutant!(0, CandidatesOfLastSearch, self.candidates.count);
        self.counters = Counters::default();
    }

    /// Checks whether the search was cancelled: then it ends like one whose limit is reached.
    pub(super) fn check_cancelled<const E: usize>(
        &mut self,
        context: &Context,
        narrow: &mut impl NarrowPhase<E>,
    ) {
        if context.is_cancelled() {
            self.is_cancelled = true;
            narrow.hits().stop();
        }
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.is_cancelled
    }

    /// Ends the search.
    ///
    /// # Errors
    /// When the search was cancelled; then there are no hits.
    pub(super) fn end<const E: usize>(&self, narrow: &mut impl NarrowPhase<E>) -> Result<(), Error> {
        if !self.is_cancelled {
            return Ok(());
        }
        narrow.hits().list.clear();
        Err(Error::Cancelled)
    }
}

/// A search that has begun.
pub(crate) struct Search<'s, const SIDES: usize, const E: usize, M, N> {
    pub(crate) sides: [Side<'s, E, M>; SIDES],
    /// The normal cones of methods that use them.
    pub(super) cones: Option<&'s mut NormalCones>,
    /// For two sides the groups of both.
    pub(super) groups: Option<GroupsBetween<'s>>,
    pub(crate) state: &'s mut SearchState,
    pub(crate) narrow: &'s mut N,
}

impl<'s, const SIDES: usize, const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>>
    Search<'s, SIDES, E, M, N>
{
    /// Begins a search for at most `limit` hits. The volumes of all sides have begun it, two sides in the same frame.
    pub(super) fn new(
        sides: [Side<'s, E, M>; SIDES],
        cones: Option<&'s mut NormalCones>,
        state: &'s mut SearchState,
        narrow: &'s mut N,
        limit: usize,
    ) -> Self {
        state.begin();
        narrow.hits().begin(limit);
        Self { sides, cones, groups: None, state, narrow }
    }
}

impl<const SIDES: usize, const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, SIDES, E, M, N> {
    /// The last side: the second one, or the only one.
    pub(super) const LAST: usize = SIDES - 1;

    /// Whether the AABBs of two nodes overlap.
    #[inline]
    pub(crate) fn overlap(&self, (n, m): NodePair) -> bool {
        self.sides[0].volumes.node(n).overlaps(self.sides[Self::LAST].volumes.node(m))
    }

    /// Checks whether the search was cancelled: then it ends like one whose limit is reached.
    pub(crate) fn check_cancelled(&mut self) {
        self.state.check_cancelled(self.sides[0].context, self.narrow);
    }

    /// Counts a visit of a node, and regularly checks for cancellation. Returns false if the search is to end.
    #[inline]
    pub(crate) fn count_visit(&mut self) -> bool {
        self.state.visits = self.state.visits.wrapping_add(1);
        if self.state.visits.is_multiple_of(VISITS_PER_CHECK) {
            self.check_cancelled();
        }
        !self.narrow.hits().note_if_full()
    }

    /// Counts a test of two triangles, and regularly checks for cancellation.
    #[inline]
    fn count_triangle_test(&mut self) {
        self.state.counters.triangle_tests += 1;
        if self.state.counters.triangle_tests.is_multiple_of(TESTS_PER_CHECK) {
            self.check_cancelled();
        }
    }

    /// Ends the search.
    ///
    /// # Errors
    /// When the search was cancelled; then there are no hits.
    pub(crate) fn end(self) -> Result<(), Error> {
        self.state.end(self.narrow)
    }

    /// Tests two triangles that are not adjacent, with the given relation.
    #[inline]
    pub(super) fn test_related_triangles(
        &mut self,
        relation: Relation,
        a: TriangleVertices,
        b: TriangleVertices,
    ) {
        if self.state.is_cancelled || !self.narrow.hits().is_complete() {
            return;
        }
        let (a, b) = if SIDES == 2 || a.triangle < b.triangle { (a, b) } else { (b, a) };
        let pair = (a.triangle, b.triangle);
        if SIDES == 2 && self.groups.is_some_and(|groups| !groups.is_counted(pair)) {
            return;
        }
        self.count_triangle_test();
        self.sides[0].move_corners(a.vertices);
        self.sides[Self::LAST].move_corners(b.vertices);
        let corners =
            [self.sides[0].volumes.corners(a.vertices), self.sides[Self::LAST].volumes.corners(b.vertices)];
        let Context { filter, .. } = self.sides[0].context;
        debug_assert!(SIDES == 2 || relation == filter.relation(pair.0, pair.1));
        let is_counted =
            || SIDES == 2 || !filter.is_excluded(pair.0, pair.1) && !self.sides[0].context.is_exception(pair);
        if let Some(hit) = self.narrow.test(filter, relation, pair, &corners[0], &corners[1])
            && is_counted()
            && !self.narrow.hits().note_if_full()
        {
            self.narrow.hits().list.push(hit);
        }
    }
}

impl<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>> Search<'_, 1, E, M, N> {
    /// Tests two triangles whose boxes overlap.
    #[inline]
    pub(crate) fn test_triangles(&mut self, a: TriangleVertices, b: TriangleVertices) {
        let relation = self.sides[0].context.filter.relation(a.triangle, b.triangle);
        if relation != Relation::Adjacent {
            self.test_related_triangles(relation, a, b);
        }
    }

    /// Tests the exceptions, one by one.
    pub(crate) fn test_exceptions(&mut self) {
        let Context { filter, exceptions, .. } = self.sides[0].context;
        for &pair in with_mutant!(&**exceptions, ExceptionsForgotten, &[]) {
            if self.narrow.hits().note_if_full() {
                return;
            }
            let [side] = &mut self.sides;
            let [a, b] = [pair.0, pair.1].map(|t| {
                let vertices = side.triangle(t).vertices;
                side.move_corners(vertices);
                side.volumes.corners(vertices)
            });
            let apart = 2.0 * side.motion.margin();
            self.state.counters.box_tests += 1;
            if self.state.counters.box_tests.is_multiple_of(BOXES_PER_CHECK) {
                self.check_cancelled();
            }
            let [box_a, box_b] = [&a, &b].map(Aabb::of_swept_triangle);
            let is_apart = if apart > 0.0 {
                with_mutant!(
                    box_a.is_farther(&box_b, apart),
                    ExceptionsOfContactsAlone,
                    box_a.is_disjoint(&box_b)
                )
            } else {
                box_a.is_disjoint(&box_b)
            };
            if is_apart {
                continue;
            }
            self.count_triangle_test();
            let relation = filter.relation(pair.0, pair.1);
            let hit = self.narrow.test(filter, relation, pair, &a, &b);
            self.narrow.hits().list.extend(hit);
        }
    }
}

/// A triangle and its vertices, by their indices in the layout.
#[derive(Clone, Copy)]
pub(crate) struct TriangleVertices {
    pub(crate) triangle: u32,
    pub(crate) vertices: [u32; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_begins_without_the_pairs_that_a_panic_left() {
        let mut state = SearchState::default();
        state.candidates.push([1, 2], [[3, 4, 5], [6, 7, 8]]);
        state.begin();
        assert_eq!(state.candidates.take(), 0);
    }
}
