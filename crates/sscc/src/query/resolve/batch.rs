//! Batches: free configurations near many colliding ones, and free samples of a distribution.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::answer::{ResolveOptions, Resolved};
use super::counted::Counted;
use crate::parallel::{map_with, on_threads};
use crate::query::query::Query;
use crate::{Error, Progress};

/// Free configurations from the draws of a distribution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FreeSamples {
    /// The free configurations, in the order of their draws.
    pub q: Vec<Vec<f64>>,
    /// The draw of each of them, counted from 0.
    pub draws: Vec<usize>,
    /// The distance of each of them from its draw, in the metric: 0 if the draw was free.
    pub changes: Vec<f64>,
    /// The number of draws.
    pub drawn: usize,
    /// The number of draws that were free.
    pub free: usize,
}

impl FreeSamples {
    /// Returns the share of draws that were free, from 0 to 1; NaN without draws.
    pub fn acceptance(&self) -> f64 {
        self.free as f64 / self.drawn as f64
    }
}

impl Query {
    /// Resolves every q of a batch as [`Query::resolve`] would, in the order given. The answers are the same for any number
    /// of threads (`None`: all cores). `progress` may cancel the batch; the token of [`Query::cancelled_by`] is not used.
    ///
    /// # Errors
    /// The error of the first q that has one; when `progress` cancels.
    pub fn resolve_batch<Q: AsRef<[f64]> + Sync>(
        &self,
        batch: &[Q],
        options: &ResolveOptions,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Resolved>, Error> {
        self.each_of(batch, threads, progress, |query, q| query.resolve(q, options))
    }

    /// Returns free configurations from the draws of any distribution. Free draws are not changed. Colliding draws are
    /// resolved if `resolve` is given. Then every draw has a sample, unless the centre collides and no start is given,
    /// but samples are denser near contact. Otherwise they are rejected: the samples have the given distribution under
    /// the condition that the shape is free.
    ///
    /// # Errors
    /// As [`Query::resolve_batch`].
    pub fn free_samples<Q: AsRef<[f64]> + Sync>(
        &self,
        draws: &[Q],
        resolve: Option<&ResolveOptions>,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<FreeSamples, Error> {
        let of_draw = |query: &mut Query, q: &[f64]| match resolve {
            Some(options) => query.resolve(q, options),
            None => {
                let is_free = Counted::new(query, true).is_free(query, q)?;
                Ok(if is_free { Resolved::free(q) } else { Resolved::NONE })
            }
        };
        let resolved = self.each_of(draws, threads, progress, of_draw)?;
        let mut samples = FreeSamples { drawn: draws.len(), ..FreeSamples::default() };
        for (draw, Resolved { q, change, .. }) in resolved.into_iter().enumerate() {
            let Some(q) = q else { continue };
            samples.free += usize::from(change == 0.0);
            samples.q.push(q);
            samples.draws.push(draw);
            samples.changes.push(change);
        }
        Ok(samples)
    }

    fn each_of<Q: AsRef<[f64]> + Sync>(
        &self,
        batch: &[Q],
        threads: Option<usize>,
        progress: &dyn Progress,
        answer: impl Fn(&mut Query, &[f64]) -> Result<Resolved, Error> + Sync,
    ) -> Result<Vec<Resolved>, Error> {
        let done = AtomicUsize::new(0);
        let query = || self.clone().cancelled_by(progress.cancel_token().cloned());
        let answer = |query: &mut Query, q: &Q| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let resolved = answer(query, q.as_ref())?;
            progress.report(done.fetch_add(1, Ordering::Relaxed) + 1, batch.len());
            Ok(resolved)
        };
        let answers: Vec<Result<Resolved, Error>> =
            on_threads(threads, || map_with(batch, usize::MAX, query, answer));
        answers.into_iter().collect()
    }
}
