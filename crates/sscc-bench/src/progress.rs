//! Progress of repetitions, and cancellation between them.

use sscc::Progress;

use crate::error::Error;

/// Stops here if the work was cancelled.
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
    /// Of `total` repetitions none is done.
    pub fn new(progress: &'a dyn Progress, total: usize) -> Self {
        Self { progress, done: 0, total }
    }

    /// One more is done. An error if the work was cancelled.
    pub fn count(&mut self) -> Result<(), Error> {
        self.done += 1;
        self.progress.report(self.done, self.total);
        check_cancelled(self.progress)
    }
}
