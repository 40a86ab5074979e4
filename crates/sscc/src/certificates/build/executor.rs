//! The interface of executors, which run the tasks of a stage, and the executor on the threads of this process.
//! `remote/executor.rs` has the one for other processes.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::preparation::Preparation;
use super::radius_search::RadiusSearch;
use super::task::{Task, TaskResult, run_task};
use crate::parallel;
use crate::{Error, Progress};

/// Tasks that are independent of each other. The next stage depends on their results.
pub(crate) struct Stage<'a> {
    /// The number of tasks.
    pub(crate) count: usize,
    /// Creates the task with an index when it is run: all tasks at once would take too much memory.
    pub(crate) task: &'a (dyn Fn(usize) -> Task + Sync),
    /// The maximum number of tasks that a thread takes at once. Costs differ, and other threads cannot take over these
    /// tasks.
    pub(crate) grain: usize,
    /// The maximum number of node pairs that all results together may add to the BVTT.
    pub(crate) max_added_pairs: usize,
    /// Receives the number of tasks that have just finished.
    pub(crate) on_finished: &'a (dyn Fn(usize) + Sync),
}

/// Runs tasks, stage by stage.
pub(crate) trait Executor {
    /// Returns the results of a stage, in the order of its tasks. None if they would add too many node pairs.
    ///
    /// # Errors
    /// When cancelled; when a callback that runs jobs fails, or a result does not belong to its job.
    fn run(&mut self, stage: &Stage<'_>) -> Result<Option<Vec<TaskResult>>, Error>;
}

/// Counts the node pairs that results add to the BVTT, up to a limit.
pub(crate) struct AddedPairLimit {
    max_added_pairs: usize,
    added: AtomicUsize,
}

impl AddedPairLimit {
    pub(crate) fn new(max_added_pairs: usize) -> Self {
        Self { max_added_pairs, added: AtomicUsize::new(0) }
    }

    pub(crate) fn add(&self, result: &TaskResult) {
        self.added.fetch_add(result.added_pairs(), Ordering::Relaxed);
    }

    pub(crate) fn is_exceeded(&self) -> bool {
        self.added.load(Ordering::Relaxed) > self.max_added_pairs
    }
}

/// Runs tasks on the threads of the current pool.
pub(crate) struct ThreadExecutor<'a> {
    pub(crate) preparation: &'a Preparation,
    pub(crate) progress: &'a dyn Progress,
}

impl Executor for ThreadExecutor<'_> {
    fn run(&mut self, stage: &Stage<'_>) -> Result<Option<Vec<TaskResult>>, Error> {
        let Self { preparation, progress } = *self;
        let limit = AddedPairLimit::new(stage.max_added_pairs);
        let run = |search: &mut RadiusSearch<'_>, index: usize| {
            if limit.is_exceeded() {
                return None;
            }
            let result = run_task((stage.task)(index), preparation, search, progress)?;
            limit.add(&result);
            (stage.on_finished)(1);
            Some(result)
        };
        let search = || preparation.search(progress);
        let results = parallel::map_with(0..stage.count, stage.grain, search, run);
        if limit.is_exceeded() {
            return Ok(None);
        }
        results.into_iter().collect::<Option<Vec<_>>>().map(Some).ok_or(Error::Cancelled)
    }
}
