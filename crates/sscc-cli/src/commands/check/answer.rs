//! The answer of `sscc check` to one query: the keys of its JSON line.

use serde::Serialize;
use sscc::Pair;

/// The answer to a discrete query at one q, or to a continuous query from one q to the next.
#[derive(Serialize)]
pub struct Answer<'a> {
    pub index: usize,
    pub norm: f64,
    pub colliding: bool,
    pub count: usize,
    pub complete: bool,
    pub pairs: &'a [Pair],
    /// The time of impact of each pair, for continuous queries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub times: Option<Vec<f64>>,
    pub microseconds: f64,
    pub root_certified: bool,
    pub opened: u64,
    pub box_tests: u64,
    pub triangle_tests: u64,
}
