//! Observers that forward the progress of work in stages or phases. One also collects its notes and warnings.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use sscc::{CancelToken, Progress};
use sscc_tasks::{Stage, Watch};

/// The total of all reports of [`Phases`].
const STEPS: usize = 1 << 20;

/// Forwards the progress of phases, one after the other, as that of one work, of which each phase has an equal share. A phase
/// begins with a report of another total.
pub struct Phases<'a> {
    progress: &'a dyn Progress,
    /// Number of phases, at least 1. Further phases count as the last one.
    count: usize,
    /// Number of phases that have begun.
    begun: AtomicUsize,
    /// The total of the current phase.
    total: AtomicUsize,
}

impl<'a> Phases<'a> {
    /// Creates an observer of this number of phases, at least 1.
    pub fn new(progress: &'a dyn Progress, count: usize) -> Self {
        Self { progress, count, begun: AtomicUsize::new(0), total: AtomicUsize::new(0) }
    }
}

impl Progress for Phases<'_> {
    fn report(&self, done: usize, total: usize) {
        if self.total.load(Ordering::Relaxed) != total && self.total.swap(total, Ordering::Relaxed) != total {
            self.begun.fetch_add(1, Ordering::Relaxed);
        }
        let before = self.begun.load(Ordering::Relaxed).min(self.count).saturating_sub(1);
        let of_phase = (done as f64 / total.max(1) as f64).min(1.0);
        let share = (before as f64 + of_phase) / self.count as f64;
        self.progress.report((share * STEPS as f64) as usize, STEPS);
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        self.progress.cancel_token()
    }
}

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
