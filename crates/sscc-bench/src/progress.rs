//! Counter of repetitions, which can be cancelled between them.

use sscc::Progress;
use sscc_tasks::check_cancelled;

use crate::error::Error;

/// Counts repetitions.
pub struct Counter<'a> {
    progress: &'a dyn Progress,
    done: usize,
    total: usize,
}

impl<'a> Counter<'a> {
    /// Creates a counter of `total` repetitions.
    pub fn new(progress: &'a dyn Progress, total: usize) -> Self {
        Self { progress, done: 0, total }
    }

    /// Counts one repetition. Returns an error if the work was cancelled.
    pub fn count(&mut self) -> Result<(), Error> {
        self.done += 1;
        self.progress.report(self.done, self.total);
        Ok(check_cancelled(self.progress)?)
    }
}
