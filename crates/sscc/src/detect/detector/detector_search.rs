//! The successive searches of a detector, and the cost of its hierarchy in them.

use super::given_motion::GivenMotion;
use crate::Error;
use crate::detect::broad_phase::BroadPhase;
use crate::detect::context::Context;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::search::{Counters, Search, SearchState, Side};

/// The hierarchy is rebuilt when its cost has grown by this factor (docs/notes/queries.md#one-shot-detector).
const MAX_COST_GROWTH: f64 = 2.0;

/// The boxes that are refitted before a search.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Refit {
    /// The boxes of all nodes and triangles: a search of a mesh with itself opens nearly all buckets.
    All,
    /// The boxes of nodes only: most buckets are far from another mesh.
    Nodes,
}

/// Searches of `E` configurations each.
#[derive(Clone)]
pub(super) struct DetectorSearch<const E: usize, N> {
    /// Created by the first search with a hierarchy.
    broad: Option<Box<BroadPhase<E>>>,
    /// The state of searches in two meshes.
    between: SearchState,
    pub(super) narrow: N,
    /// The cost of the hierarchy in the first search.
    first_cost: f64,
    /// The cost of the hierarchy in the last search.
    pub(super) cost: f64,
    pub(super) counters: Counters,
}

impl<const E: usize, N: Default> Default for DetectorSearch<E, N> {
    fn default() -> Self {
        let (between, narrow, counters) = (SearchState::default(), N::default(), Counters::default());
        Self { broad: None, between, narrow, first_cost: 0.0, cost: 0.0, counters }
    }
}

impl<const E: usize, N: NarrowPhase<E>> DetectorSearch<E, N> {
    /// Refits the boxes that a search needs. False if the hierarchy should be rebuilt.
    pub(super) fn begin(&mut self, context: &Context, motion: &GivenMotion<'_, E>, refit: Refit) -> bool {
        let is_first = self.broad.is_none();
        let broad = self.broad.get_or_insert_with(|| Box::new(BroadPhase::new(&context.layout, false, None)));
        match refit {
            Refit::All => broad.volumes.begin(&context.hierarchy, motion),
            Refit::Nodes => broad.volumes.begin_nodes(&context.hierarchy, motion),
        }
        self.cost = broad.volumes.surface_area_cost();
        if is_first {
            self.first_cost = self.cost;
        }
        self.cost <= MAX_COST_GROWTH * self.first_cost
    }

    /// Finds at most `limit` hits of the mesh with itself, not sorted, after [`Self::begin`].
    ///
    /// # Errors
    /// When the search was cancelled; then there are no hits.
    pub(super) fn find(
        &mut self,
        context: &Context,
        motion: &GivenMotion<'_, E>,
        limit: usize,
    ) -> Result<(), Error> {
        let Some(broad) = &mut self.broad else { return Ok(()) };
        let mut search = broad.search_begun(context, motion, &mut self.narrow, limit);
        search.traverse((0, 0));
        let result = search.end();
        self.counters = broad.state.counters;
        result
    }

    /// Finds at most `limit` hits of this mesh with another one, not sorted, after [`Self::begin`] of both in one frame.
    ///
    /// # Errors
    /// When the token of the first context cancels; then there are no hits.
    pub(super) fn find_between(
        &mut self,
        other: &mut Self,
        contexts: [&Context; 2],
        [x, y]: &[GivenMotion<'_, E>; 2],
        limit: usize,
    ) -> Result<(), Error> {
        let (Some(first), Some(second)) = (&mut self.broad, &mut other.broad) else { return Ok(()) };
        let sides = [
            Side { context: contexts[0], volumes: &mut first.volumes, motion: x },
            Side { context: contexts[1], volumes: &mut second.volumes, motion: y },
        ];
        let groups = contexts[0].filter.groups_against(&contexts[1].filter);
        let result = Search::between(sides, groups, &mut self.between, &mut self.narrow, limit);
        self.counters = self.between.counters;
        result
    }
}
