//! The state of a search: AABBs, traversal stack, counters, cancellation. It hands triangle pairs with overlapping
//! AABBs to the [`NarrowPhase`], and tests the exceptions.
//!
//! The tests of nodes are in [`traversal`](super::traversal), those of buckets in [`bucket_pair`](super::bucket_pair).

use std::sync::Arc;

use super::context::Context;
use super::layout::Layout;
use super::narrow_phase::NarrowPhase;
use super::node_volumes::NodeVolumes;
use super::normal_cones::NormalCones;
use super::vertex_motion::VertexMotion;
use crate::Error;
use crate::filter::Relation;
use crate::geometry::Aabb;
use crate::hierarchy::NodePair;

/// Triangle tests between two checks whether the search was cancelled: one test may take a millisecond.
const TESTS_PER_CHECK: u64 = 64;

/// Nodes visited between two checks. A visit takes at most about 10 microseconds, triangle tests apart.
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

/// Volumes and scratch memory of searches at `E` configurations.
#[derive(Clone)]
pub(crate) struct BroadPhase<const E: usize> {
    pub(crate) volumes: NodeVolumes<E>,
    /// The normal cones of methods that use them; only in discrete searches.
    pub(crate) cones: Option<NormalCones>,
    /// Nodes `(n, n)` and node pairs `(n, m)` still to be visited: see [`traversal`](super::traversal).
    pub(super) stack: Vec<NodePair>,
    /// A bucket pair whose test is deferred until the next one is found. Meanwhile its memory is fetched.
    deferred: Option<(u32, u32)>,
    visits: u32,
    /// Tested pairs of buckets whose own AABBs do not overlap, although those by which they were found do.
    pub(crate) loose_pairs: usize,
    is_cancelled: bool,
    pub(crate) counters: Counters,
}

impl<const E: usize> BroadPhase<E> {
    /// Lazy searches compute boxes where the traversal visits nodes, others refit all of them first. `cones`: those of the
    /// method, if it uses any.
    pub(crate) fn new(layout: &Arc<Layout>, is_lazy: bool, cones: Option<NormalCones>) -> Self {
        Self {
            volumes: NodeVolumes::new(layout, is_lazy),
            cones: cones.filter(|_| E == 1),
            stack: Vec::new(),
            deferred: None,
            visits: 0,
            loose_pairs: 0,
            is_cancelled: false,
            counters: Counters::default(),
        }
    }

    /// Resets the counters.
    #[inline]
    pub(crate) fn begin(&mut self) {
        self.is_cancelled = false;
        self.deferred = None;
        self.loose_pairs = 0;
        self.counters = Counters::default();
    }

    /// Starts a search: all boxes are those of this motion from now on.
    pub(crate) fn begin_volumes(&mut self, context: &Context, motion: &impl VertexMotion<E>) {
        self.volumes.begin(&context.hierarchy, motion);
        if let Some(cones) = &mut self.cones {
            cones.update(&context.hierarchy, &self.volumes);
        }
    }

    /// Defers the test of a bucket pair until the next call, or until [`Self::test_deferred_bucket_pair`], and prefetches its
    /// memory.
    #[inline]
    pub(crate) fn defer_bucket_pair<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        (a, b): (u32, u32),
        motion: &M,
        narrow: &mut N,
    ) {
        [a, b].iter().for_each(|bucket| self.volumes.prefetch_bucket(*bucket));
        if let Some(pair) = self.deferred.replace((a, b)) {
            self.test_bucket_pair(context, pair, motion, narrow);
        }
    }

    /// Tests the deferred bucket pair, at the end of a traversal.
    #[inline]
    pub(crate) fn test_deferred_bucket_pair<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        motion: &M,
        narrow: &mut N,
    ) {
        if let Some(pair) = right_or!(self.deferred.take(), LastBucketPairForgotten, None) {
            self.test_bucket_pair(context, pair, motion, narrow);
        }
    }

    /// Checks whether the search was cancelled: then it ends like one whose limit is reached.
    pub(crate) fn check_cancelled<N: NarrowPhase<E>>(&mut self, context: &Context, narrow: &mut N) {
        if context.is_cancelled() {
            self.is_cancelled = true;
            narrow.hits().stop();
        }
    }

    /// Counts a visit of a node, and checks for cancellation now and then. Returns false if the search is to end.
    #[inline]
    pub(crate) fn count_visit<N: NarrowPhase<E>>(&mut self, context: &Context, narrow: &mut N) -> bool {
        self.visits = self.visits.wrapping_add(1);
        if self.visits.is_multiple_of(VISITS_PER_CHECK) {
            self.check_cancelled(context, narrow);
        }
        !narrow.hits().note_if_full()
    }

    /// Counts a test of two triangles, and checks now and then.
    #[inline]
    pub(super) fn count_triangle_test<N: NarrowPhase<E>>(&mut self, context: &Context, narrow: &mut N) {
        self.counters.triangle_tests += 1;
        if self.counters.triangle_tests.is_multiple_of(TESTS_PER_CHECK) {
            self.check_cancelled(context, narrow);
        }
    }

    /// The end of a search.
    ///
    /// # Errors
    /// When it was cancelled; then there are no hits.
    pub(crate) fn end<N: NarrowPhase<E>>(&mut self, narrow: &mut N) -> Result<(), Error> {
        if !self.is_cancelled {
            return Ok(());
        }
        narrow.hits().list.clear();
        Err(Error::Cancelled)
    }

    /// Tests two triangles whose boxes overlap.
    #[inline]
    pub(crate) fn test_triangles<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        a: TriangleVertices,
        b: TriangleVertices,
        motion: &M,
        narrow: &mut N,
    ) {
        let relation = context.filter.relation(a.triangle, b.triangle);
        if relation != Relation::Adjacent {
            self.test_related_triangles(context, relation, a, b, motion, narrow);
        }
    }

    /// The same for two triangles that are not adjacent, whose relation is known.
    #[inline]
    pub(super) fn test_related_triangles<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        relation: Relation,
        a: TriangleVertices,
        b: TriangleVertices,
        motion: &M,
        narrow: &mut N,
    ) {
        if self.is_cancelled {
            return;
        }
        let (a, b) = if a.triangle < b.triangle { (a, b) } else { (b, a) };
        let pair = (a.triangle, b.triangle);
        debug_assert_eq!(relation, context.filter.relation(pair.0, pair.1));
        self.count_triangle_test(context, narrow);
        [a, b].iter().for_each(|t| self.volumes.move_corners(t.vertices, motion));
        let [a, b] = [a, b].map(|t| self.volumes.corners(t.vertices));
        if let Some(hit) = N::test(&context.filter, relation, pair, &a, &b)
            && !context.filter.is_excluded(pair.0, pair.1)
            && !context.is_exception(pair)
            && !narrow.hits().note_if_full()
        {
            narrow.hits().list.push(hit);
        }
    }

    /// Tests the exceptions, one by one.
    pub(crate) fn test_exceptions<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        motion: &M,
        narrow: &mut N,
    ) {
        for &pair in right_or!(&*context.exceptions, ExceptionsForgotten, &[]) {
            if narrow.hits().note_if_full() {
                return;
            }
            let [a, b] = [pair.0, pair.1].map(|t| {
                let vertices = self.triangle(context, t).vertices;
                self.volumes.move_corners(vertices, motion);
                self.volumes.corners(vertices)
            });
            self.counters.box_tests += 1;
            if self.counters.box_tests.is_multiple_of(BOXES_PER_CHECK) {
                self.check_cancelled(context, narrow);
            }
            if Aabb::of_swept_triangle(&a).is_disjoint(&Aabb::of_swept_triangle(&b)) {
                continue;
            }
            self.count_triangle_test(context, narrow);
            let relation = context.filter.relation(pair.0, pair.1);
            let hit = N::test(&context.filter, relation, pair, &a, &b);
            narrow.hits().list.extend(hit);
        }
    }

    /// A triangle of the mesh with the indices of its vertices in the layout.
    pub(crate) fn triangle(&self, context: &Context, triangle: u32) -> TriangleVertices {
        let face = context.filter.faces()[triangle as usize];
        TriangleVertices { triangle, vertices: face.map(|v| self.volumes.layout.vertices.index_of(v)) }
    }
}

/// A triangle and its vertices, by their indices in the layout.
#[derive(Clone, Copy)]
pub(crate) struct TriangleVertices {
    pub(crate) triangle: u32,
    pub(crate) vertices: [u32; 3],
}
