//! One large model certified by many processes, with the same result byte for byte.
//!
//! [`Certificates::compute_in_shards`] makes the jobs of one stage after the other, as bytes, and a function that is
//! given to it has them done: each by a [`ShardWorker`] in any process that was given the same model and options. What
//! comes back is sealed: a result that was damaged, or is of another model, options or build, is refused.

mod job;
mod seal;
#[cfg(test)]
mod tests;

pub use self::seal::BUILD;

use self::job::{Job, read_grown, read_radii, too_many};
use self::seal::Key;
use super::{Certificates, CertifyOptions};
use crate::certificates::build::node_radii::{Radii, Tally};
use crate::certificates::build::pair_tree_builder::{Grown, Round};
use crate::certificates::build::search::Precision;
use crate::certificates::build::task::{NodeTask, Prepared, Solver};
use crate::threads::on_threads;
use crate::{Error, Progress, ReducedModel};

/// Has jobs done, each by [`ShardWorker::run`] somewhere; gives the results in the order of the jobs.
pub type RunJobs<'a> = dyn FnMut(Vec<Vec<u8>>) -> Result<Vec<Vec<u8>>, Error> + 'a;

impl Certificates {
    /// As [`Certificates::compute`], by workers: each stage as at most `shards` jobs, which `run` has done. Every shard
    /// count gives the same certificates. A few times as many shards as workers keep all of them busy to the end.
    ///
    /// # Errors
    /// As `compute`; what `run` returns; [`Error::Shard`] for a result that is none of the job's.
    pub fn compute_in_shards(
        model: &ReducedModel,
        options: &CertifyOptions,
        shards: usize,
        run: &mut RunJobs<'_>,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        if shards == 0 {
            return Err(Error::Option { name: "shards", value: 0.0, wanted: "at least 1" });
        }
        let prepared = on_threads(options.threads, || Prepared::new(model, options, progress))?;
        let key = Key::of(&prepared);
        let mut elsewhere = Elsewhere { prepared: &prepared, key, shards, run, progress };
        let radii = Radii::compute(&prepared, options.budget, &mut elsewhere, progress)?;
        Ok(Self { parts: radii.of(prepared) })
    }
}

/// Does jobs of one model; may be shared by threads.
pub struct ShardWorker {
    prepared: Prepared,
    key: Key,
}

impl ShardWorker {
    /// Prepares what all jobs need: model and options as given to [`Certificates::compute_in_shards`] (the budget and
    /// the number of threads apart).
    ///
    /// # Errors
    /// As [`Certificates::compute`].
    pub fn new(
        model: &ReducedModel,
        options: &CertifyOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let prepared = on_threads(options.threads, || Prepared::new(model, options, progress))?;
        let key = Key::of(&prepared);
        Ok(Self { prepared, key })
    }

    /// Does a job, on the thread that calls.
    ///
    /// # Errors
    /// [`Error::Shard`] for bytes that are no job of this model, these options and this build; when `progress` cancels.
    pub fn run(&self, job: &[u8], progress: &dyn Progress) -> Result<Vec<u8>, Error> {
        let tasks = Job::read(&self.prepared.hierarchy, self.key.open("a job", job)?)
            .ok_or_else(|| Error::Shard("a job is not of this hierarchy".to_owned()))?;
        let mut body = Key::name(job).to_vec();
        body.extend(tasks.solve(&self.prepared, progress)?);
        Ok(self.key.seal(&body))
    }
}

/// Solves tasks by jobs that are done elsewhere.
struct Elsewhere<'a> {
    prepared: &'a Prepared,
    key: Key,
    shards: usize,
    run: &'a mut RunJobs<'a>,
    progress: &'a dyn Progress,
}

impl Elsewhere<'_> {
    /// Has the tasks of a stage done: job j of k has the tasks j, j + k, j + 2k, ..., since neighbours are often
    /// equally hard. Results are given in the order of the jobs, together with their number.
    fn run(
        &mut self,
        count: usize,
        job: impl Fn(&mut dyn Iterator<Item = usize>) -> Job,
    ) -> Result<Vec<Vec<u8>>, Error> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        if count == 0 {
            return Ok(Vec::new());
        }
        let jobs = self.shards.min(count);
        let sealed: Vec<Vec<u8>> =
            (0..jobs).map(|j| self.key.seal(&job(&mut (j..count).step_by(jobs)).write())).collect();
        let names: Vec<[u8; 32]> = sealed.iter().map(|job| Key::name(job)).collect();
        let results = (self.run)(sealed)?;
        if results.len() != jobs {
            return Err(Error::Shard(format!("{} results came back for {jobs} jobs", results.len())));
        }
        let open = |(result, name): (Vec<u8>, [u8; 32])| {
            let body = self.key.open("a result", &result)?;
            let of_job = body.strip_prefix(&name);
            of_job.map(<[u8]>::to_vec).ok_or_else(|| Error::Shard("a result is of another job".to_owned()))
        };
        results.into_iter().zip(names).map(open).collect()
    }
}

fn malformed() -> Error {
    Error::Shard("a result does not fit its job".to_owned())
}

/// Puts the results of jobs back into the order of their tasks.
fn in_order<T>(count: usize, jobs: Vec<Vec<T>>) -> Vec<T> {
    let mut jobs: Vec<_> = jobs.into_iter().map(Vec::into_iter).collect();
    let of = jobs.len().max(1);
    (0..count).filter_map(|task| jobs[task % of].next()).collect()
}

impl Solver for Elsewhere<'_> {
    fn grow(&mut self, open: &[Grown], round: Round) -> Result<Option<Vec<Vec<Grown>>>, Error> {
        let of = |tasks: &mut dyn Iterator<Item = usize>| tasks.map(|at| open[at]).collect::<Vec<_>>();
        let results = self.run(open.len(), |tasks| Job::Grow(round, of(tasks)))?;
        if results.iter().any(|result| too_many(result)) {
            return Ok(None);
        }
        let jobs = results.len();
        let read = |(j, result): (usize, &Vec<u8>)| {
            let pairs = of(&mut (j..open.len()).step_by(jobs));
            read_grown(&self.prepared.hierarchy, &pairs, result).ok_or_else(malformed)
        };
        let lists = results.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
        let lists = in_order(open.len(), lists);
        let used: usize = lists.iter().map(|list| list.len() - 1).sum();
        Ok((used <= round.room).then_some(lists))
    }

    fn radii(
        &mut self,
        precision: Precision,
        count: usize,
        task: &(dyn Fn(usize) -> NodeTask + Sync),
        tally: &Tally<'_>,
    ) -> Result<Vec<(f64, f64)>, Error> {
        let results = self.run(count, |tasks| Job::Radii(precision, tasks.map(task).collect()))?;
        tally.add(count);
        let jobs = results.len();
        let read = |(j, result): (usize, &Vec<u8>)| {
            read_radii((j..count).step_by(jobs).len(), result).ok_or_else(malformed)
        };
        let radii = results.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
        Ok(in_order(count, radii))
    }
}
