//! Collisions at one q.

use std::time::Instant;

use serde::{Deserialize, Serialize};
use sscc::{Certificates, Pair, Query};

use super::nodes::{Frontier, frontier};
use crate::ViewError;

/// Pairs that are looked for: a shape that is crumpled beyond that need not be counted while it is dragged.
pub(super) const MOST_FOUND: usize = 100_000;

/// Pairs that are listed.
pub(super) const MOST_LISTED: usize = 10_000;

/// A q to look at.
#[derive(Clone, Debug, Deserialize)]
pub struct CheckRequest {
    /// Where.
    pub q: Vec<f64>,
    /// Comes back with the answer, which may be late.
    #[serde(default)]
    pub serial: u64,
    /// Whether to tell which nodes had to be opened.
    #[serde(default)]
    pub nodes: bool,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckAnswer {
    /// That of the request.
    pub serial: u64,
    /// `|z|`.
    pub norm: f64,
    /// Whether any pair collides.
    pub colliding: bool,
    /// How many pairs do; a lower bound where the answer is not complete.
    pub count: usize,
    /// Whether everything was looked at.
    pub complete: bool,
    /// The first of them, sorted.
    pub pairs: Vec<Pair>,
    /// Every triangle of any pair found, sorted.
    pub triangles: Vec<u32>,
    /// What the query took.
    pub microseconds: f64,
    /// Whether the root's certificate alone proved it, exceptions apart.
    pub root_certified: bool,
    /// Nodes and pairs of nodes opened.
    pub opened: u64,
    /// Boxes compared.
    pub box_tests: u64,
    /// Triangles compared.
    pub triangle_tests: u64,
    /// `|z|` over the root's radius; none where that is 0.
    pub root_share: Option<f64>,
    /// Which nodes the certificates leave open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<Frontier>,
}

pub(super) fn check(
    query: &mut Query<'_>,
    certificates: &Certificates,
    request: &CheckRequest,
) -> Result<CheckAnswer, ViewError> {
    let CheckRequest { q, serial, nodes } = request;
    let (found, microseconds) = timed(|| query.discrete_at_most(q, MOST_FOUND).map(|_| ()));
    found?;
    let (pairs, statistics, norm) = (query.pairs(), query.statistics(), query.norm());
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
        pairs: pairs[..pairs.len().min(MOST_LISTED)].to_vec(),
        triangles,
        microseconds,
        root_certified: statistics.root_certified,
        opened: statistics.opened,
        box_tests: statistics.box_tests,
        triangle_tests: statistics.triangle_tests,
        root_share: (root > 0.0).then_some(norm / root),
        nodes: nodes.then(|| frontier(certificates, norm)),
    })
}

/// With what it took in microseconds.
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let done = work();
    (done, start.elapsed().as_secs_f64() * 1e6)
}
