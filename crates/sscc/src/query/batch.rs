//! Batches: discrete queries of many q in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use super::configuration::Configuration;
use super::configuration_check::ConfigurationCheck;
use super::query::Query;
use super::search_group::{Answer, SearchGroup, is_far};
use super::statistics::Statistics;
use crate::detect::expected_buckets::GROUP;
use crate::thread_pool::on_threads;
use crate::{Error, Progress};

/// Progress is reported once for this many q, which costs the cheapest queries nothing.
const REPORT_INTERVAL: usize = 64;

impl Query {
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
            for (index, answer) in batch.answer_open(self, &open)? {
                answers[index] = answer;
            }
            Ok(answers)
        });
        progress.report(batch.rows.len(), batch.rows.len());
        answers
    }
}

/// The indices of the q of a batch that the root does not prove free.
struct OpenRows {
    /// Those that are searched alone, ascending.
    near: Vec<usize>,
    /// Those that are searched in groups, by ascending norm, because at similar norms the same radii are reached.
    far: Vec<usize>,
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
    /// Answers each q that the root's certificate proves free, and finds all others, whose answers are empty.
    ///
    /// # Errors
    /// That of the first q that has one; when it was cancelled.
    fn answer_by_root(&self, query: &Query) -> Result<(Vec<Answer>, OpenRows), Error> {
        let open = Mutex::new((Vec::new(), Vec::new()));
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
            let (near, far) = &mut *lock(&open);
            if is_far(&query.context, norm, self.limit) {
                far.push((norm, index));
            } else {
                near.push(index);
            }
            Ok(Answer { pairs: Vec::new(), norm, statistics: Statistics::default() })
        };
        let answers: Vec<Result<Answer, Error>> =
            self.rows.par_iter().enumerate().map_init(|| query.check.clone(), answer).collect();
        let answers = answers.into_iter().collect::<Result<Vec<Answer>, Error>>()?;
        let (mut near, mut far) = open.into_inner().unwrap_or_else(PoisonError::into_inner);
        near.sort_unstable();
        far.sort_unstable_by(|(r, i), (s, j)| r.total_cmp(s).then(i.cmp(j)));
        Ok((answers, OpenRows { near, far: far.into_iter().map(|(_, index)| index).collect() }))
    }

    /// Answers the q that the root does not prove free.
    ///
    /// # Errors
    /// When it was cancelled.
    fn answer_open(&self, query: &Query, open: &OpenRows) -> Result<Vec<(usize, Answer)>, Error> {
        self.done.fetch_max(self.rows.len() - open.near.len() - open.far.len(), Ordering::Relaxed);
        let idle = Mutex::new(Vec::new());
        let answer = |group: &[usize]| {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let first = lock(&idle).pop();
            let mut searches =
                first.unwrap_or_else(|| SearchGroup::new(query, self.progress.cancel_token().cloned()));
            let rows: Vec<&[f64]> = group.iter().map(|index| self.rows[*index].as_ref()).collect();
            let answers = searches.answer(&rows, self.limit)?;
            lock(&idle).push(searches);
            self.report(group.len());
            Ok(group.iter().copied().zip(answers).collect())
        };
        // No thread is idle for the sake of groups.
        let group_len = open.far.len().div_ceil(rayon::current_num_threads()).clamp(1, GROUP);
        let groups = open.far.par_chunks(group_len).chain(open.near.par_chunks(1));
        let answers: Result<Vec<Vec<(usize, Answer)>>, Error> = groups.map(answer).collect();
        Ok(answers?.into_iter().flatten().collect())
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
