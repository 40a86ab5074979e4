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
    /// Sweeps modes over ranges of their weights, with all other weights as in q: for each mode upwards from its weight in q
    /// to `high`, then downwards to `low`. If the weight in q is outside of the range, there is one sweep, from the nearer
    /// end of the range to the other one. The results are the same for any number of threads (`None`: all cores).
    /// `progress` may cancel the sweeps; the token of [`Query::cancelled_by`] is not used.
    ///
    /// [`ReducedModel::weight_limits`](crate::ReducedModel::weight_limits) returns suitable ranges for modes of any unit.
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
        for range in ranges {
            let ModeRange { mode, low, high } = *range;
            let from = range.check(q)?.clamp(low, high);
            ways.extend([high, low].into_iter().filter(|to| *to != from).map(|to| (mode, from, to)));
        }
        self.map_sweeps(q, &ways, threads, progress, |query, at, &(mode, from, to)| {
            at[mode] = from;
            query.sweep(at, mode, to)
        })
    }

    /// Maps sweeps from q, a configuration of the model, to their results in parallel. Each sweep has its own query and copy of q.
    ///
    /// # Errors
    /// The error of the first sweep that has one.
    pub(super) fn map_sweeps<W: Sync, R: Send>(
        &self,
        q: &[f64],
        ways: &[W],
        threads: Option<usize>,
        progress: &dyn Progress,
        map: impl Fn(&mut Query, &mut [f64], &W) -> Result<R, Error> + Sync,
    ) -> Result<Vec<R>, Error> {
        let done = AtomicUsize::new(0);
        let start = || (self.clone().cancelled_by(progress.cancel_token().cloned()), q.to_vec());
        let one = |(query, at): &mut (Query, Vec<f64>), way: &W| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            at.copy_from_slice(q);
            let found = map(query, at, way)?;
            progress.report(done.fetch_add(1, Ordering::Relaxed) + 1, ways.len());
            Ok(found)
        };
        let all: Vec<Result<R, Error>> = on_threads(threads, || map_with(ways, 1, start, one));
        all.into_iter().collect()
    }
}

impl ModeRange {
    /// Returns the weight of the mode in q.
    ///
    /// # Errors
    /// When q has no such mode; when the range is empty or not finite.
    pub(super) fn check(&self, q: &[f64]) -> Result<f64, Error> {
        let Self { mode, low, high } = *self;
        let weight = *q.get(mode).ok_or(Error::ModeIndex { mode, rank: q.len() })?;
        if low < high && (high - low).is_finite() {
            Ok(weight)
        } else {
            Err(Error::SweepRange { mode, low, high })
        }
    }
}
