//! The memory of searches of one shape with itself, and the functions that begin them.

use std::sync::Arc;

use super::context::Context;
use super::layout::Layout;
use super::narrow_phase::NarrowPhase;
use super::node_volumes::NodeVolumes;
use super::normal_cones::NormalCones;
use super::search::{Search, SearchState, Side};
use super::vertex_motion::VertexMotion;

/// Volumes and scratch memory of searches at `E` configurations.
#[derive(Clone)]
pub(crate) struct BroadPhase<const E: usize> {
    pub(crate) volumes: NodeVolumes<E>,
    /// The normal cones of methods that use them; only in discrete searches.
    pub(crate) cones: Option<NormalCones>,
    pub(crate) state: SearchState,
}

impl<const E: usize> BroadPhase<E> {
    /// Allocates the memory. Lazy searches compute boxes when the traversal visits nodes, others refit all boxes first.
    /// `cones`: the normal cones of the method, if it uses any.
    pub(crate) fn new(layout: &Arc<Layout>, is_lazy: bool, cones: Option<NormalCones>) -> Self {
        Self {
            volumes: NodeVolumes::new(layout, is_lazy),
            cones: cones.filter(|_| E == 1),
            state: SearchState::default(),
        }
    }

    /// Begins a search of this motion for at most `limit` hits.
    pub(crate) fn search<'s, M: VertexMotion<E>, N: NarrowPhase<E>>(
        &'s mut self,
        context: &'s Context,
        motion: &'s M,
        narrow: &'s mut N,
        limit: usize,
    ) -> Search<'s, 1, E, M, N> {
        self.volumes.begin(&context.hierarchy, motion);
        self.search_begun(context, motion, narrow, limit)
    }

    /// Begins a search whose volumes have begun it already.
    pub(super) fn search_begun<'s, M: VertexMotion<E>, N: NarrowPhase<E>>(
        &'s mut self,
        context: &'s Context,
        motion: &'s M,
        narrow: &'s mut N,
        limit: usize,
    ) -> Search<'s, 1, E, M, N> {
        let Self { volumes, cones, state } = self;
        if let Some(cones) = cones {
            cones.update(&context.hierarchy, volumes);
        }
        Search::new([Side { context, volumes, motion }], cones.as_mut(), state, narrow, limit)
    }
}
