//! Batches: many sets of positions (frames) in parallel.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::detector::Detector;
use crate::detect::answer::Answer;
use crate::parallel::{map_with, on_threads};
use crate::{Error, Pair, Progress};
use glam::DVec3;

impl Detector {
    /// Answers every frame as [`Detector::discrete`] would, in the order given. The pairs are the same for any number of
    /// threads (`None`: all cores). `progress` may cancel the batch; the token of [`Detector::cancelled_by`] is not used.
    ///
    /// # Errors
    /// The error of the first frame that has one; when `progress` cancels.
    pub fn batch<X: AsRef<[DVec3]> + Sync>(
        &self,
        frames: &[X],
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Answer>, Error> {
        self.answer_all(frames, threads, progress, |detector, x| detector.discrete(x).map(<[Pair]>::to_vec))
    }

    /// Answers as [`Detector::batch`], with at most `limit` pairs for each frame: see [`Detector::discrete_at_most`].
    ///
    /// # Errors
    /// As [`Detector::batch`].
    pub fn batch_at_most<X: AsRef<[DVec3]> + Sync>(
        &self,
        frames: &[X],
        limit: usize,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<Answer>, Error> {
        let at_most =
            |detector: &mut Detector, x: &[DVec3]| detector.discrete_at_most(x, limit).map(<[Pair]>::to_vec);
        self.answer_all(frames, threads, progress, at_most)
    }

    /// Answers every frame by `find`.
    fn answer_all<X: AsRef<[DVec3]> + Sync>(
        &self,
        frames: &[X],
        threads: Option<usize>,
        progress: &dyn Progress,
        find: impl Fn(&mut Detector, &[DVec3]) -> Result<Vec<Pair>, Error> + Sync,
    ) -> Result<Vec<Answer>, Error> {
        let done = AtomicUsize::new(0);
        let detector = || self.clone().cancelled_by(progress.cancel_token().cloned());
        let answer = |detector: &mut Detector, positions: &X| {
            if progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let pairs = find(detector, positions.as_ref())?;
            progress.report(done.fetch_add(1, Ordering::Relaxed) + 1, frames.len());
            Ok(Answer { pairs, statistics: detector.statistics() })
        };
        let answers: Vec<Result<Answer, Error>> =
            on_threads(threads, || map_with(frames, usize::MAX, detector, answer));
        answers.into_iter().collect()
    }
}
