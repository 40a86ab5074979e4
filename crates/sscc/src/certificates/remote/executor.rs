//! `compute_in_shards`, and the executor that sends tasks as jobs to other processes.

use super::job::JobWriter;
use super::job_result::{JobResult, ResultLayout};
use super::seal::{HASH, Key};
use crate::certificates::build::{AddedPairLimit, CertifiedRadii, Executor, Preparation, Stage, TaskResult};
use crate::certificates::{Certificates, CertifyOptions};
use crate::parallel::on_threads;
use crate::{Error, Progress, ReducedModel};

/// Runs jobs, each by [`ShardWorker::run`](super::ShardWorker::run) in some process, and returns the results in the order of the
/// jobs.
pub type RunJobs<'a> = dyn FnMut(Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, Error> + 'a;

/// Computes certificates like [`Certificates::compute`], but by workers: `run` runs the jobs of each stage, at most `shards` of
/// them. Every number of shards gives the same certificates. With a few times as many shards as workers, all workers are busy to
/// the end.
///
/// # Errors
/// Those of `compute` and of `run`; [`Error::Option`] if `shards` is 0; [`Error::Shard`] if a result is damaged or does
/// not belong to its job, or `run` returns another number of results than of jobs.
pub fn compute_in_shards(
    model: &ReducedModel,
    options: &CertifyOptions,
    shards: usize,
    run: &mut RunJobs<'_>,
    progress: &dyn Progress,
) -> Result<Certificates, Error> {
    if shards == 0 {
        return Err(Error::Option { name: "shards", value: 0.0, wanted: "at least 1" });
    }
    let preparation = on_threads(options.threads, || Preparation::new(model, options, progress))?;
    let key = Key::of(&preparation);
    let mut executor = RemoteExecutor { preparation: &preparation, key, shards, run, progress };
    let radii = CertifiedRadii::compute(&preparation, options.budget, &mut executor, progress)?;
    on_threads(options.threads, || radii.into_certificates(model, options, preparation, progress))
}

/// Writes the tasks of a stage as jobs, runs these by a callback, and reads their results.
struct RemoteExecutor<'a> {
    preparation: &'a Preparation,
    key: Key,
    shards: usize,
    run: &'a mut RunJobs<'a>,
    progress: &'a dyn Progress,
}

/// A job that was sealed, and the layouts that are needed to read its result.
struct SealedJob {
    bytes: Vec<u8>,
    layouts: Vec<ResultLayout>,
}

impl RemoteExecutor<'_> {
    /// Seals a job. Job j of k has the tasks j, j + k, j + 2k, ..., because neighbours often take equally long.
    fn seal(&self, stage: &Stage<'_>, job: usize, jobs: usize) -> SealedJob {
        let (mut writer, mut layouts) = (JobWriter::new(stage.max_added_pairs), Vec::new());
        for index in (job..stage.count).step_by(jobs) {
            let task = (stage.task)(index);
            writer.add(&task);
            layouts.push(ResultLayout::of(&task));
        }
        SealedJob { bytes: self.key.seal(&writer.into_bytes()), layouts }
    }

    /// Reads the result of the job with this name.
    fn open(&self, name: [u8; HASH], layouts: &[ResultLayout], result: &[u8]) -> Result<JobResult, Error> {
        let body = self.key.open("a result", result)?;
        let body =
            body.strip_prefix(&name).ok_or_else(|| Error::Shard("a result is of another job".to_owned()))?;
        JobResult::read(&self.preparation.hierarchy, layouts, body)
            .ok_or_else(|| Error::Shard("a result does not fit its job".to_owned()))
    }
}

impl Executor for RemoteExecutor<'_> {
    fn run(&mut self, stage: &Stage<'_>) -> Result<Option<Vec<TaskResult>>, Error> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        let jobs = self.shards.min(stage.count);
        if jobs == 0 {
            return Ok(Some(Vec::new()));
        }
        let (mut bytes, mut known) = (Vec::with_capacity(jobs), Vec::with_capacity(jobs));
        for job in 0..jobs {
            let sealed = self.seal(stage, job, jobs);
            known.push((Key::name(&sealed.bytes), sealed.layouts));
            bytes.push(sealed.bytes);
        }
        let results = (self.run)(bytes)?;
        if results.len() != jobs {
            return Err(Error::Shard(format!("{} results were returned for {jobs} jobs", results.len())));
        }
        let mut of_jobs = Vec::with_capacity(jobs);
        for (result, (name, layouts)) in results.into_iter().zip(known) {
            of_jobs.push(self.open(name, &layouts, &result)?);
        }
        (stage.on_finished)(stage.count);
        Ok(in_order(stage, of_jobs))
    }
}

/// Returns the results in the order of their tasks. None if they would add too many node pairs.
fn in_order(stage: &Stage<'_>, jobs: Vec<JobResult>) -> Option<Vec<TaskResult>> {
    let complete = |job: JobResult| match job {
        JobResult::OutOfRoom => None,
        JobResult::Complete(results) => Some(results.into_iter()),
    };
    let mut jobs = jobs.into_iter().map(complete).collect::<Option<Vec<_>>>()?;
    let (limit, count) = (AddedPairLimit::new(stage.max_added_pairs), jobs.len());
    let results: Vec<TaskResult> =
        (0..stage.count).filter_map(|index| jobs[index % count].next()).inspect(|r| limit.add(r)).collect();
    (!limit.is_exceeded()).then_some(results)
}
