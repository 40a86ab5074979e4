//! Observer that forwards the progress of work in stages, and collects its notes and warnings.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use sscc::{CancelToken, Progress};
use sscc_tasks::{Stage, Watch};

/// Forwards progress to `progress`, and keeps notes.
pub struct Watching<'a> {
    progress: &'a dyn Progress,
    /// Whether only steps of simulations are reported, so that the finished share never decreases.
    has_steps: bool,
    is_reported: AtomicBool,
    notes: Mutex<Vec<String>>,
}

impl<'a> Watching<'a> {
    /// Creates an observer that reports all stages.
    pub fn all(progress: &'a dyn Progress) -> Self {
        Self { progress, has_steps: false, is_reported: AtomicBool::new(true), notes: Mutex::default() }
    }

    /// Creates an observer that reports only the steps of a simulation.
    pub fn steps(progress: &'a dyn Progress) -> Self {
        Self { has_steps: true, is_reported: AtomicBool::new(false), ..Self::all(progress) }
    }

    /// Returns the notes and warnings.
    pub fn notes(self) -> Vec<String> {
        self.notes.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for Watching<'_> {
    fn report(&self, done: usize, total: usize) {
        if self.is_reported.load(Ordering::Relaxed) {
            self.progress.report(done, total);
        }
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        self.progress.cancel_token()
    }
}

impl Watch for Watching<'_> {
    fn begin(&self, stage: Stage) {
        if self.has_steps {
            self.is_reported.store(matches!(stage, Stage::Steps { .. }), Ordering::Relaxed);
        }
    }

    fn note(&self, note: &str) {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note.into());
    }
}
