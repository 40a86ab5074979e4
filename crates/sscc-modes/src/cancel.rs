//! Cancellation of computations of modes.

use sscc::{Error, Progress};

/// Checks whether the work is cancelled.
///
/// # Errors
/// When the work is cancelled.
pub(crate) fn check_cancelled(progress: &dyn Progress) -> Result<(), Error> {
    if progress.is_cancelled() { Err(Error::Cancelled) } else { Ok(()) }
}

/// Number of tests from one check for cancellation to the next: less than a millisecond.
const TESTS_PER_CHECK: usize = 4096;

/// Counts tests of loops within loops, and checks for cancellation once in [`TESTS_PER_CHECK`].
pub(crate) struct TestCounter<'a> {
    progress: &'a dyn Progress,
    tests: usize,
}

impl<'a> TestCounter<'a> {
    /// Begins at 0.
    pub fn new(progress: &'a dyn Progress) -> Self {
        Self { progress, tests: 0 }
    }

    /// Counts the tests that follow.
    ///
    /// # Errors
    /// When the work is cancelled.
    pub fn add(&mut self, tests: usize) -> Result<(), Error> {
        self.tests += tests;
        if self.tests < TESTS_PER_CHECK {
            return Ok(());
        }
        self.tests = 0;
        check_cancelled(self.progress)
    }
}
