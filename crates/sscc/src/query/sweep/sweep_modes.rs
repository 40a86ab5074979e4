//! Sweeps of several modes in both directions, in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::sweep::Sweep;
use crate::parallel::{map_with, on_threads};
use crate::query::query::Query;
use crate::{Error, Progress};

/// The weights over which a mode is swept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeRange {
    /// The mode, from 0.
    pub mode: usize,
    /// The smallest weight.
    pub low: f64,
    /// The largest weight.
    pub high: f64,
}

impl Query {
    /// Sweeps modes over ranges of their weights, with all others as in q: for each mode upwards from
    /// its weight in q to `high`, then downwards to `low`. Where the weight in q is outside of the range, one sweep goes
    /// from the nearer end of the range to the other one. The results are the same for any number of threads (none: all
    /// cores). `progress` may cancel them; that of [`Query::cancelled_by`] is not used.
    ///
    /// [`ReducedModel::weight_limits`](crate::ReducedModel::weight_limits) is a range for modes of any unit.
    ///
    /// # Errors
    /// When a range is empty or not finite; as [`Query::sweep`], for the first sweep that has an error.
    pub fn sweep_modes(
        &self,
        q: &[f64],
        ranges: &[ModeRange],
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Sweep>, Error> {
        self.context.model.check_coordinates(q)?;
        let mut ways = Vec::with_capacity(2 * ranges.len());
        for &ModeRange { mode, low, high } in ranges {
            let weight = *q.get(mode).ok_or(Error::ModeIndex { mode, rank: q.len() })?;
            if !(low < high && (high - low).is_finite()) {
                return Err(Error::SweepRange { mode, low, high });
            }
            let from = weight.clamp(low, high);
            ways.extend([high, low].into_iter().filter(|to| *to != from).map(|to| (mode, from, to)));
        }
        let done = AtomicUsize::new(0);
        let start = || (self.clone().cancelled_by(progress.cancel_token().cloned()), q.to_vec());
        let sweep = |(query, at): &mut (Query, Vec<f64>), &(mode, from, to): &(usize, f64, f64)| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            at.copy_from_slice(q);
            at[mode] = from;
            let found = query.sweep(at, mode, to)?;
            progress.report(done.fetch_add(1, Ordering::Relaxed) + 1, ways.len());
            Ok(found)
        };
        let all: Vec<Result<Sweep, Error>> = on_threads(threads, || map_with(&ways, 1, start, sweep));
        all.into_iter().collect()
    }
}
