//! Many q at once, on all cores.

use rayon::prelude::*;

use super::{Query, Statistics};
use crate::threads::on_threads;
use crate::{Error, Pair, Progress};

/// The answer for one q of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// All colliding pairs, sorted.
    pub pairs: Vec<Pair>,
    /// [`Query::norm`]
    pub norm: f64,
    /// What it cost.
    pub statistics: Statistics,
}

impl Query<'_> {
    /// Answers every q of a batch as [`Query::discrete`] would, in the order given: the same answers for any number
    /// of threads (none: all cores).
    ///
    /// # Errors
    /// That of the first q that has one; when `progress` cancels.
    pub fn batch<Q: AsRef<[f64]> + Sync>(
        &self,
        batch: &[Q],
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Answer>, Error> {
        let answer = |query: &mut Query<'_>, q: &Q| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let pairs = query.discrete(q.as_ref())?.to_vec();
            Ok(Answer { pairs, norm: query.norm(), statistics: query.statistics() })
        };
        let answers: Vec<Result<Answer, Error>> =
            on_threads(threads, || batch.par_iter().map_init(|| self.clone(), answer).collect());
        progress.report(batch.len(), batch.len());
        answers.into_iter().collect()
    }
}
