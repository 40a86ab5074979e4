//! The worker: runs jobs of one model in any process.

use super::job::Job;
use super::job_result::JobResult;
use super::seal::Key;
use crate::certificates::CertifyOptions;
use crate::certificates::build::{Prepared, Room, run_task};
use crate::threads::on_threads;
use crate::{Error, Progress, ReducedModel};

/// Runs jobs of one model; threads may share it.
pub struct ShardWorker {
    pub(super) prepared: Prepared,
    pub(super) key: Key,
}

impl ShardWorker {
    /// Prepares what all jobs need. Model and options are those given to
    /// [`Certificates::compute_in_shards`](crate::Certificates::compute_in_shards); budget and number of threads may
    /// differ.
    ///
    /// # Errors
    /// As [`Certificates::compute`](crate::Certificates::compute).
    pub fn new(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let prepared = on_threads(options.threads, || Prepared::new(model, options, progress))?;
        let key = Key::of(&prepared);
        Ok(Self { prepared, key })
    }

    /// Runs a job on the calling thread; gives the bytes of its result.
    ///
    /// # Errors
    /// [`Error::Shard`] for bytes that are no job of this model, these options and this build; when `progress` cancels.
    pub fn run(&self, job: &[u8], progress: &dyn Progress) -> Result<Vec<u8>, Error> {
        let name = Key::name(job);
        let job = Job::read(&self.prepared.hierarchy, self.key.open("a job", job)?)
            .ok_or_else(|| Error::Shard("a job is not of this hierarchy".to_owned()))?;
        let result = self.run_tasks(job, progress).filter(|_| !progress.is_cancelled());
        let mut body = name.to_vec();
        body.extend(result.ok_or(Error::Cancelled)?.to_bytes());
        Ok(self.key.seal(&body))
    }

    /// None if cancelled.
    fn run_tasks(&self, job: Job, progress: &dyn Progress) -> Option<JobResult> {
        let mut search = self.prepared.search(progress);
        let room = Room::new(job.room);
        let mut results = Vec::with_capacity(job.tasks.len());
        for task in job.tasks {
            let result = run_task(task, &self.prepared, &mut search, progress)?;
            room.add(&result);
            if room.is_exceeded() {
                return Some(JobResult::OutOfRoom);
            }
            results.push(result);
        }
        Some(JobResult::Complete(results))
    }
}
