//! Progress of repetitions, and cancellation between them.

use sscc::Progress;

use crate::error::Error;

/// Returns an error if `progress` cancels.
pub fn check_cancelled(progress: &dyn Progress) -> Result<(), Error> {
    if progress.is_cancelled() { Err(sscc::Error::Cancelled.into()) } else { Ok(()) }
}

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
        check_cancelled(self.progress)
    }
}
