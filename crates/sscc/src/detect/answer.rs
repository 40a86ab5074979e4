//! The answer for one shape of a batch, its cost, and the kind of its proof.

use super::search::Counters;
use crate::{Error, Pair};

/// The kind of proof of the answer of a query.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Proof {
    /// The root's radius: one comparison.
    Radius,
    /// The root's local certificate: the strain of the whole shape.
    Local,
    /// A search of the hierarchy.
    #[default]
    Search,
}

names! { Proof, "proof": Radius = "radius", Local = "local", Search = "search" }

/// The answer for one q, or one set of positions, of a batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Answer {
    /// All colliding pairs, sorted.
    pub pairs: Vec<Pair>,
    /// The cost of this answer.
    pub statistics: Statistics,
}

/// The cost of an answer, and the kind of its proof.
///
/// Every call that answers a question replaces the statistics of the last one, also if it ends with an error. After a success
/// `complete` is true, unless a limit stopped the search. After an error `complete` and `root_certified` are false; `norm` is that
/// of the q at which the call ended, 0 if it refused q; the counters are those of the search that the error stopped, for a sweep
/// also of those before it, and 0 if there was none. A call with two detectors sets the statistics of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// `|z| = |S (q - center)|`, rounded up, in the metric and about the centre of the query; for a continuous query the larger
    /// norm of start and end. 0 for a [`Detector`](crate::Detector), which has no q.
    pub norm: f64,
    /// Whether the root's certificate alone proved the shape free, exceptions apart: its radius or its local certificate.
    pub root_certified: bool,
    /// The kind of proof of the answer, exceptions apart.
    pub proof: Proof,
    /// Whether the answer is complete: all pairs are listed, or the question is answered. False if a limit or an error stopped the
    /// call.
    pub complete: bool,
    /// Nodes and node pairs that were opened.
    pub opened: u64,
    /// Pairs of boxes compared.
    pub box_tests: u64,
    /// Pairs of triangles tested exactly.
    pub triangle_tests: u64,
    /// The cost of a detector's refitted hierarchy by the surface area heuristic; 0 for a query.
    pub tree_cost: f64,
    /// The number of times that a detector has rebuilt its hierarchy; 0 for a query.
    pub rebuilds: u64,
}

impl Statistics {
    /// The cost of a query that the root's certificate alone answers.
    pub(crate) const PROVEN_FREE: Self = Self {
        norm: 0.0,
        root_certified: true,
        proof: Proof::Radius,
        complete: true,
        opened: 0,
        box_tests: 0,
        triangle_tests: 0,
        tree_cost: 0.0,
        rebuilds: 0,
    };

    /// Sets the kind of proof.
    pub(crate) fn set_proof(&mut self, proof: Proof) {
        self.proof = proof;
        self.root_certified = proof != Proof::Search;
    }

    /// Notes whether a call succeeded, and returns its result.
    pub(crate) fn finish<T>(&mut self, result: Result<T, Error>) -> Result<T, Error> {
        self.complete = result.is_ok();
        if result.is_err() {
            self.set_proof(Proof::Search);
        }
        result
    }

    /// Copies the counters of a search.
    pub(crate) fn set_counters(&mut self, counters: &Counters) {
        let Counters { opened, box_tests, triangle_tests, .. } = *counters;
        (self.opened, self.box_tests, self.triangle_tests) = (opened, box_tests, triangle_tests);
    }
}
