//! The searches of a detector, one after the other, and the cost of its hierarchy in them.

use super::given_motion::GivenMotion;
use crate::Error;
use crate::detect::broad_phase::{BroadPhase, Counters};
use crate::detect::context::Context;
use crate::detect::narrow_phase::NarrowPhase;

/// The hierarchy is built again when its cost has grown by this factor (docs/notes/2026-11-23-one-shot.md).
const MAX_COST_GROWTH: f64 = 2.0;

/// Searches of `E` configurations each.
#[derive(Clone)]
pub(super) struct Search<const E: usize, N> {
    /// Made by the first search with a hierarchy.
    broad: Option<Box<BroadPhase<E>>>,
    pub(super) narrow: N,
    /// The cost of the hierarchy in the first search and in the last one.
    first_cost: f64,
    pub(super) cost: f64,
    pub(super) counters: Counters,
}

impl<const E: usize, N: Default> Default for Search<E, N> {
    fn default() -> Self {
        Self { broad: None, narrow: N::default(), first_cost: 0.0, cost: 0.0, counters: Counters::default() }
    }
}

impl<const E: usize, N: NarrowPhase<E>> Search<E, N> {
    /// Starts a search for at most `limit` hits: refits all boxes. False if the hierarchy should be built again.
    pub(super) fn begin(&mut self, context: &Context, motion: &GivenMotion<'_, E>, limit: usize) -> bool {
        let is_first = self.broad.is_none();
        let broad = self.broad.get_or_insert_with(|| Box::new(BroadPhase::new(&context.layout, false, None)));
        self.narrow.hits().begin(limit);
        broad.begin();
        broad.begin_volumes(context, motion);
        self.cost = broad.volumes.surface_area_cost();
        if is_first {
            self.first_cost = self.cost;
        }
        self.cost <= MAX_COST_GROWTH * self.first_cost
    }

    /// The broad phase of a search that has begun.
    pub(super) fn parts(&mut self) -> Option<(&mut BroadPhase<E>, &mut N)> {
        self.broad.as_deref_mut().map(|broad| (broad, &mut self.narrow))
    }

    /// Finds all hits, not sorted.
    ///
    /// # Errors
    /// When it was cancelled; then there are no hits.
    pub(super) fn find(&mut self, context: &Context, motion: &GivenMotion<'_, E>) -> Result<(), Error> {
        let Some(broad) = &mut self.broad else { return Ok(()) };
        broad.traverse(context, (0, 0), motion, &mut self.narrow);
        self.counters = broad.counters;
        broad.end(&mut self.narrow)
    }
}
