//! Discrete queries of the page.

use std::time::Instant;

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Pair, Query};

use super::nodes::{Frontier, frontier};
use crate::ViewError;

/// Largest number of pairs that a query searches, so that heavily colliding shapes still have quick answers.
pub(super) const MAX_PAIRS: usize = 100_000;

/// Largest number of pairs in an answer.
pub(super) const MAX_LISTED_PAIRS: usize = 10_000;

/// A discrete query.
#[derive(Clone, Debug, Deserialize)]
pub struct CheckRequest {
    /// The q (r numbers).
    pub q: Vec<f64>,
    /// A number that the answer repeats, so that the page recognises late answers.
    #[serde(default)]
    pub serial: u64,
    /// Whether the answer lists the nodes that the certificates do not prove free.
    #[serde(default)]
    pub nodes: bool,
}

/// The result of a discrete query.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckAnswer {
    /// The serial of the request.
    pub serial: u64,
    /// `|z|`.
    pub norm: f64,
    /// Whether any pair collides.
    pub colliding: bool,
    /// The number of colliding pairs; a lower bound if the answer is not complete.
    pub count: usize,
    /// Whether the search ended before its limit.
    pub complete: bool,
    /// The first colliding pairs, sorted.
    pub pairs: Vec<Pair>,
    /// All triangles of the colliding pairs found, sorted.
    pub triangles: Vec<u32>,
    /// Time of the query (microseconds).
    pub microseconds: f64,
    /// Whether the root's certificate alone proved the shape free, apart from exceptions: its radius or its local certificate.
    pub root_certified: bool,
    /// Kind of the proof that decided the answer, apart from exceptions: `radius`, `local` or `search`.
    pub proof: &'static str,
    /// Number of opened nodes and node pairs.
    pub opened: u64,
    /// Number of AABB tests.
    pub box_tests: u64,
    /// Number of triangle tests.
    pub triangle_tests: u64,
    /// `|z|` over the root's radius; `None` if the radius is 0.
    pub root_share: Option<f64>,
    /// The nodes that the certificates do not prove free, on request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<Frontier>,
}

/// Answers a discrete query.
pub(super) fn check(
    query: &mut Query,
    certificates: &Certificates,
    request: &CheckRequest,
) -> Result<CheckAnswer, ViewError> {
    let CheckRequest { q, serial, nodes } = request;
    let (found, microseconds) = timed(|| query.discrete_at_most(q, MAX_PAIRS).map(|_| ()));
    found?;
    let (pairs, statistics, norm) = (query.pairs(), query.statistics(), query.statistics().norm);
    let mut triangles: Vec<u32> = pairs.iter().flat_map(|(i, j)| [*i, *j]).collect();
    triangles.sort_unstable();
    triangles.dedup();
    let root = certificates.root_radius();
    Ok(CheckAnswer {
        serial: *serial,
        norm,
        colliding: !pairs.is_empty(),
        count: pairs.len(),
        complete: statistics.complete,
        pairs: pairs[..pairs.len().min(MAX_LISTED_PAIRS)].to_vec(),
        triangles,
        microseconds,
        root_certified: statistics.root_certified,
        proof: statistics.proof.into(),
        opened: statistics.opened,
        box_tests: statistics.box_tests,
        triangle_tests: statistics.triangle_tests,
        root_share: (root > 0.0).then_some(norm / root),
        nodes: nodes.then(|| frontier(certificates, norm)),
    })
}

/// Returns the result of `work` and its time (microseconds).
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed().as_secs_f64() * 1e6)
}
