//! Counts finished steps and reports them to a `Progress`.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::{Error, Progress};

/// The number of steps between two reports.
const REPORT_INTERVAL: usize = 64;

/// Counts finished steps and reports them at intervals.
pub(super) struct ProgressCounter<'a> {
    progress: &'a dyn Progress,
    done: AtomicUsize,
    total: usize,
}

impl<'a> ProgressCounter<'a> {
    pub(super) fn new(progress: &'a dyn Progress, total: usize) -> Self {
        Self { progress, done: AtomicUsize::new(0), total }
    }

    /// Counts steps that have finished.
    pub(super) fn add(&self, count: usize) {
        let before = self.done.fetch_add(count, Ordering::Relaxed);
        if before / REPORT_INTERVAL != (before + count) / REPORT_INTERVAL {
            self.progress.report(before + count, self.total);
        }
    }

    /// Reports that all steps have finished.
    ///
    /// # Errors
    /// When cancelled.
    pub(super) fn finish(&self) -> Result<(), Error> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        self.progress.report(self.total, self.total);
        Ok(())
    }
}
