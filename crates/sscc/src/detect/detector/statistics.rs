//! The statistics of a detector.

use super::detector_search::DetectorSearch;
use crate::detect::answer::Statistics;
use crate::detect::narrow_phase::NarrowPhase;

impl Statistics {
    /// Those of a detector that has no answer.
    pub(super) fn forget(self) -> Self {
        Self { rebuilds: self.rebuilds, ..Self::default() }
    }

    /// Takes over those of a search.
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
