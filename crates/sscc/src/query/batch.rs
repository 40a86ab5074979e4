//! Batches: discrete queries of many q in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::query::Query;
use crate::detect::answer::{Answer, Statistics};
use crate::parallel::{map, map_with, on_threads};
use crate::{Error, Progress};

/// A thread reports the q that the root's certificate proves free once for this many, so that reports do not slow down the
/// cheapest queries.
const REPORT_INTERVAL: usize = 64;

impl Query {
    /// Answers every q of a batch as [`Query::discrete`] would, in the order given. The answers are the same for any number
    /// of threads (`None`: all cores). `progress` may cancel the batch; the token of [`Query::cancelled_by`] has no effect.
    ///
    /// # Errors
    /// The error of the first q that has one; when `progress` cancels.
    pub fn batch<Q: AsRef<[f64]> + Sync>(
        &self,
        batch: &[Q],
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Answer>, Error> {
        self.batch_at_most(batch, usize::MAX, threads, progress)
    }

    /// Answers as [`Query::batch`], with at most `limit` pairs for each q: see [`Query::discrete_at_most`].
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
        let batch = Batch { rows: batch, limit, progress, done: AtomicUsize::new(0) };
        let answers: Result<Vec<Answer>, Error> = on_threads(threads, || {
            let mut answers = batch.answer_by_root(self)?;
            batch.answer_open(self, &mut answers)?;
            answers.into_iter().map(|answer| answer.ok_or(Error::Cancelled)).collect()
        });
        if answers.is_ok() {
            progress.report(batch.rows.len(), batch.rows.len());
        }
        answers
    }
}

/// The q of a batch, and the options of its queries.
struct Batch<'b, Q> {
    rows: &'b [Q],
    limit: usize,
    progress: &'b dyn Progress,
    /// The number of answers so far.
    done: AtomicUsize,
}

impl<Q: AsRef<[f64]> + Sync> Batch<'_, Q> {
    /// Checks every q, and answers those that the root's certificate proves free; `None` for the others.
    ///
    /// # Errors
    /// The error of the first q that has one; when the batch was cancelled.
    fn answer_by_root(&self, query: &Query) -> Result<Vec<Option<Answer>>, Error> {
        let answer = |(check, unreported): &mut (ConfigurationCheck, usize), q: &Q| {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let Configuration { norm, .. } = check.measure(&query.context, q.as_ref())?;
            let is_free = query.context.is_proven_free(norm);
            *unreported += usize::from(is_free);
            if *unreported == REPORT_INTERVAL {
                self.report(std::mem::take(unreported));
            }
            let free =
                || Answer { pairs: Vec::new(), statistics: Statistics { norm, ..Statistics::PROVEN_FREE } };
            Ok(is_free.then(free))
        };
        let answers: Vec<Result<Option<Answer>, Error>> =
            map_with(self.rows, usize::MAX, || (query.check.clone(), 0), answer);
        answers.into_iter().collect()
    }

    /// Answers the q that have no answer yet.
    ///
    /// # Errors
    /// When the batch was cancelled, or a thread's arithmetic is not that of IEEE 754.
    fn answer_open(&self, query: &Query, answers: &mut [Option<Answer>]) -> Result<(), Error> {
        let open: Vec<_> = answers.iter_mut().zip(self.rows).filter(|(answer, _)| answer.is_none()).collect();
        self.done.fetch_max(self.rows.len() - open.len(), Ordering::Relaxed);
        // Queries that are not in use: each has memory for the whole shape.
        let idle = Mutex::new(Vec::new());
        let first = || query.discrete_alone().cancelled_by(self.progress.cancel_token().cloned());
        let answer = |(answer, q): (&mut Option<Answer>, &Q)| {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let of_others = lock(&idle).pop();
            let mut query = of_others.unwrap_or_else(first);
            let pairs = query.discrete_at_most(q.as_ref(), self.limit)?.to_vec();
            *answer = Some(Answer { pairs, statistics: query.statistics() });
            lock(&idle).push(query);
            self.report(1);
            Ok(())
        };
        map(open, answer).into_iter().collect()
    }

    /// Adds `more` to the number of answers, and reports the new number.
    fn report(&self, more: usize) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        self.progress.report(done, self.rows.len());
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
