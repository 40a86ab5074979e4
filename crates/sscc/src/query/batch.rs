//! Batches: discrete queries of many q in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::query::Query;
use super::search_group::{Answer, SearchGroup, is_far};
use super::statistics::Statistics;
use crate::detect::buckets_ahead::GROUP;
use crate::thread_pool::on_threads;
use crate::{Error, Progress};

/// Progress is reported once for this many q, which costs the cheapest queries nothing.
const REPORT_INTERVAL: usize = 64;

impl Query<'_> {
    /// Answers every q of a batch as [`Query::discrete`] would, in the order given: the same answers for any number
    /// of threads (none: all cores). `progress` may cancel it; that of [`Query::cancelled_by`] is not used.
    ///
    /// Far from rest it takes less time than single queries: vertices are moved for several q at once.
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
        let batch = Batch { rows: batch, limit, progress, done: AtomicUsize::new(0) };
        let answers = on_threads(threads, || {
            let (mut answers, open) = batch.answer_by_root(self)?;
            for (index, answer) in batch.answer_in_groups(self, &open)? {
                answers[index] = answer;
            }
            Ok(answers)
        });
        progress.report(batch.rows.len(), batch.rows.len());
        answers
    }
}

/// The q of a batch, and how they are to be answered.
struct Batch<'b, Q> {
    rows: &'b [Q],
    limit: usize,
    progress: &'b dyn Progress,
    /// How many answers are known.
    done: AtomicUsize,
}

impl<Q: AsRef<[f64]> + Sync> Batch<'_, Q> {
    /// Answers each q that the root's certificate proves free. Returns the indices of all others, too, whose answers are
    /// empty: first those that are searched alone, then those that are searched in groups, each ascending.
    ///
    /// # Errors
    /// That of the first q that has one; when it was cancelled.
    fn answer_by_root(&self, query: &Query<'_>) -> Result<(Vec<Answer>, Vec<usize>), Error> {
        let open = Mutex::new(Vec::new());
        let answer = |check: &mut ConfigurationCheck, (index, q): (usize, &Q)| {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let Configuration { norm, .. } = check.measure(&query.context, q.as_ref())?;
            if query.context.is_proven_free(norm) {
                if index.is_multiple_of(REPORT_INTERVAL) {
                    self.report(REPORT_INTERVAL);
                }
                return Ok(Answer { pairs: Vec::new(), norm, statistics: Statistics::PROVEN_FREE });
            }
            lock(&open).push((is_far(&query.context, norm, self.limit), index));
            Ok(Answer { pairs: Vec::new(), norm, statistics: Statistics::default() })
        };
        let answers: Vec<Result<Answer, Error>> =
            self.rows.par_iter().enumerate().map_init(|| query.check.clone(), answer).collect();
        let answers = answers.into_iter().collect::<Result<Vec<Answer>, Error>>()?;
        let mut open = open.into_inner().unwrap_or_else(PoisonError::into_inner);
        open.sort_unstable();
        Ok((answers, open.into_iter().map(|(_, index)| index).collect()))
    }

    /// Answers the q of these indices, in groups.
    ///
    /// # Errors
    /// When it was cancelled.
    fn answer_in_groups(&self, query: &Query<'_>, open: &[usize]) -> Result<Vec<(usize, Answer)>, Error> {
        self.done.store(self.rows.len() - open.len(), Ordering::Relaxed);
        let idle = Mutex::new(Vec::new());
        let answer = |group: &[usize]| {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let first = lock(&idle).pop();
            let mut searches = first.unwrap_or_else(|| SearchGroup::new(query, self.progress));
            let rows: Vec<&[f64]> = group.iter().map(|index| self.rows[*index].as_ref()).collect();
            let answers = searches.answer(&rows, self.limit)?;
            lock(&idle).push(searches);
            self.report(group.len());
            Ok(group.iter().copied().zip(answers).collect())
        };
        let groups: Result<Vec<Vec<(usize, Answer)>>, Error> = open.par_chunks(GROUP).map(answer).collect();
        Ok(groups?.into_iter().flatten().collect())
    }

    /// Reports that so many more answers are known.
    fn report(&self, more: usize) {
        let before = self.done.fetch_add(more, Ordering::Relaxed);
        self.progress.report(before.min(self.rows.len()), self.rows.len());
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
