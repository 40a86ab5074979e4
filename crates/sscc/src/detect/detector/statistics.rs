//! The cost of an answer of a detector.

use super::detector_search::DetectorSearch;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::search::Counters;

/// The cost of the last answer of a [`Detector`](crate::Detector), and the state of its hierarchy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DetectorStatistics {
    /// Whether the search was complete: the pairs listed are all. False where a limit stopped it, or an error.
    pub complete: bool,
    /// Nodes and node pairs that were opened.
    pub opened: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles tested exactly.
    pub triangle_tests: u64,
    /// The cost of the refitted hierarchy by the surface area heuristic.
    pub tree_cost: f64,
    /// How often the hierarchy has been built again since the detector was made.
    pub rebuilds: u64,
}

impl DetectorStatistics {
    /// Those of a detector that has no answer.
    pub(super) fn forget(self) -> Self {
        Self { rebuilds: self.rebuilds, ..Self::default() }
    }

    /// Takes over those of a search.
    pub(super) fn set<const E: usize, N: NarrowPhase<E>>(
        &mut self,
        search: &mut DetectorSearch<E, N>,
        is_done: bool,
    ) {
        let Counters { opened, box_tests, triangle_tests, .. } = search.counters;
        let complete = is_done && search.narrow.hits().is_complete();
        let (tree_cost, rebuilds) = (search.cost, self.rebuilds);
        *self = Self { complete, opened, box_tests, triangle_tests, tree_cost, rebuilds };
    }
}
