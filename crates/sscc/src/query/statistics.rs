//! The cost of a query.

use crate::detect::search::Counters;

/// What proved the answer of a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Proof {
    /// The root's radius: one comparison.
    Radius,
    /// The root's local certificate: the strain of the whole shape.
    Local,
    /// A search.
    #[default]
    Search,
}

impl Proof {
    /// Its name in files and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radius => "radius",
            Self::Local => "local",
            Self::Search => "search",
        }
    }
}

/// The cost of the last query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Whether the root's certificate alone proved the shape free, exceptions apart: its radius or its local certificate.
    pub root_certified: bool,
    /// What proved the answer, exceptions apart.
    pub proof: Proof,
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
    pub(super) const PROVEN_FREE: Self = Self {
        root_certified: true,
        proof: Proof::Radius,
        complete: true,
        opened: 0,
        box_tests: 0,
        triangle_tests: 0,
    };

    /// Says what proved the answer.
    pub(super) fn set_proof(&mut self, proof: Proof) {
        self.proof = proof;
        self.root_certified = proof != Proof::Search;
    }

    /// Takes over the counters of a search.
    pub(super) fn set_counters(&mut self, counters: &Counters) {
        let Counters { opened, box_tests, triangle_tests, .. } = *counters;
        (self.opened, self.box_tests, self.triangle_tests) = (opened, box_tests, triangle_tests);
    }
}
