//! The statistics of a detector.

use super::detector_search::DetectorSearch;
use crate::detect::answer::Statistics;
use crate::detect::narrow_phase::NarrowPhase;

impl Statistics {
    /// Returns the statistics of a detector without an answer.
    pub(super) fn forget(self) -> Self {
        Self { rebuilds: self.rebuilds, ..Self::default() }
    }

    /// Copies the statistics of a search.
    pub(super) fn set_search<const E: usize, N: NarrowPhase<E>>(
        &mut self,
        search: &mut DetectorSearch<E, N>,
        is_done: bool,
    ) {
        self.set_counters(&search.counters);
        self.complete = is_done && search.narrow.hits().is_complete();
        self.tree_cost = search.cost;
    }
}
