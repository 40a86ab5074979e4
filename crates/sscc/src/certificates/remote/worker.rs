//! The worker: runs jobs of one model in any process.

use super::job::Job;
use super::job_result::JobResult;
use super::seal::Key;
use crate::arithmetic::check_arithmetic;
use crate::certificates::CertifyOptions;
use crate::certificates::build::{AddedPairLimit, Preparation, run_task};
use crate::parallel::on_threads;
use crate::{Error, Progress, ReducedModel};

/// Runs jobs of one model; threads may share it.
pub struct ShardWorker {
    pub(super) preparation: Preparation,
    pub(super) key: Key,
}

impl ShardWorker {
    /// Prepares the input of all jobs. Model and options are those given to [`compute_in_shards`](super::compute_in_shards);
    /// budgets and number of threads may differ.
    ///
    /// # Errors
    /// Those of [`Certificates::compute`](crate::Certificates::compute).
    pub fn new(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let preparation = on_threads(options.threads, || Preparation::new(model, options, progress))?;
        let key = Key::of(&preparation);
        Ok(Self { preparation, key })
    }

    /// Runs a job on the calling thread, and returns the bytes of its result.
    ///
    /// # Errors
    /// [`Error::Shard`] for bytes that are no job of this model, these options and this build; [`Error::Arithmetic`] if
    /// this thread's arithmetic is not that of IEEE 754; when `progress` cancels.
    pub fn run(&self, job: &[u8], progress: &dyn Progress) -> Result<Vec<u8>, Error> {
        check_arithmetic()?;
        let name = Key::name(job);
        let job = Job::read(&self.preparation.hierarchy, self.key.open("a job", job)?)
            .ok_or_else(|| Error::Shard("a job does not fit the hierarchy of the model".to_owned()))?;
        let result = self.run_tasks(job, progress).filter(|_| !progress.is_cancelled());
        let mut body = name.to_vec();
        body.extend(result.ok_or(Error::Cancelled)?.to_bytes());
        Ok(self.key.seal(&body))
    }

    /// Runs the tasks of a job. None if cancelled.
    fn run_tasks(&self, job: Job, progress: &dyn Progress) -> Option<JobResult> {
        let mut search = self.preparation.search(progress);
        let limit = AddedPairLimit::new(job.max_added_pairs);
        let mut results = Vec::with_capacity(job.tasks.len());
        for task in job.tasks {
            let result = run_task(task, &self.preparation, &mut search, progress)?;
            limit.add(&result);
            if limit.is_exceeded() {
                return Some(JobResult::OutOfRoom);
            }
            results.push(result);
        }
        Some(JobResult::Complete(results))
    }
}
