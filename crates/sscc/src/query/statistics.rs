//! The cost of a query.

use crate::detect::broad_phase::Counters;

/// The cost of the last query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Whether the root's certificate alone proved the shape free, exceptions apart.
    pub root_certified: bool,
    /// Whether the search was complete: the pairs listed are all. False where a limit stopped the query, or an error.
    pub complete: bool,
    /// Nodes and node pairs that were opened.
    pub opened: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles tested exactly.
    pub triangle_tests: u64,
}

impl Statistics {
    /// The cost of a query that the root's certificate alone answers.
    pub(super) const PROVEN_FREE: Self =
        Self { root_certified: true, complete: true, opened: 0, box_tests: 0, triangle_tests: 0 };

    /// Takes over the counters of a search.
    pub(super) fn set_counters(&mut self, counters: &Counters) {
        let Counters { opened, box_tests, triangle_tests, .. } = *counters;
        (self.opened, self.box_tests, self.triangle_tests) = (opened, box_tests, triangle_tests);
    }
}
