//! Batches: discrete queries of many q in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::query::Query;
use super::statistics::Statistics;
use crate::thread_pool::on_threads;
use crate::{Error, Pair, Progress};

/// The answer for one q of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// All colliding pairs, sorted.
    pub pairs: Vec<Pair>,
    /// [`Query::norm`]
    pub norm: f64,
    /// The cost of this q.
    pub statistics: Statistics,
}

/// Progress is reported once for this many q, which costs the cheapest queries nothing.
const REPORT_INTERVAL: usize = 64;

impl Query<'_> {
    /// Answers every q of a batch as [`Query::discrete`] would, in the order given: the same answers for any number
    /// of threads (none: all cores). `progress` may cancel it; that of [`Query::cancelled_by`] is not used.
    ///
    /// # Errors
    /// That of the first q that has one; when `progress` cancels.
    pub fn batch<Q: AsRef<[f64]> + Sync>(
        &self,
        batch: &[Q],
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Answer>, Error> {
        self.batch_at_most(batch, usize::MAX, threads, progress)
    }

    /// As [`Query::batch`], at most `limit` pairs of each q: see [`Query::discrete_at_most`].
    ///
    /// # Errors
    /// As [`Query::batch`].
    pub fn batch_at_most<Q: AsRef<[f64]> + Sync>(
        &self,
        batch: &[Q],
        limit: usize,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Answer>, Error> {
        let done = AtomicUsize::new(0);
        let query = || self.clone().cancelled_by(progress);
        let answer = |query: &mut Query<'_>, (index, q): (usize, &Q)| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let pairs = query.discrete_at_most(q.as_ref(), limit)?.to_vec();
            if index.is_multiple_of(REPORT_INTERVAL) {
                progress.report(done.fetch_add(REPORT_INTERVAL, Ordering::Relaxed), batch.len());
            }
            Ok(Answer { pairs, norm: query.norm(), statistics: query.statistics() })
        };
        let answers: Vec<Result<Answer, Error>> =
            on_threads(threads, || batch.par_iter().enumerate().map_init(query, answer).collect());
        progress.report(batch.len(), batch.len());
        answers.into_iter().collect()
    }
}
