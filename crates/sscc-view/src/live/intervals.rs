//! The intervals of one mode: the marks along its slider.

use serde::Deserialize;
use sscc::{ModeRange, Query};
use sscc_tasks::IntervalRow;

use super::cancellation::Cancellation;
use crate::ViewError;

/// Number of samples of the weight.
const SAMPLES: usize = 101;

/// A mode and the range of its weight.
#[derive(Clone, Debug, Deserialize)]
pub struct IntervalsRequest {
    /// The q with the other weights (r numbers).
    q: Vec<f64>,
    /// The mode, from 0.
    mode: usize,
    /// The smallest and the largest weight.
    range: [f64; 2],
}

/// Finds the intervals of a mode.
pub(super) fn intervals(
    query: &Query,
    IntervalsRequest { q, mode, range }: &IntervalsRequest,
    cancellation: &Cancellation,
) -> Result<IntervalRow, ViewError> {
    let [low, high] = *range;
    let ranges = [ModeRange { mode: *mode, low, high }];
    let found = query.sweep_intervals(q, &ranges, SAMPLES, None, cancellation);
    let mut found = found.map_err(|error| cancellation.explain(error))?;
    // The request has one range, so there is one result.
    let found = found.pop().ok_or_else(|| ViewError::Request("there is no mode".into()))?;
    Ok(IntervalRow::new(found, &[]))
}
