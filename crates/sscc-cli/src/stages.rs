//! The progress bars and notes of work with several stages, such as a simulation.

use std::sync::{Mutex, PoisonError};

use sscc::{CancelToken, Progress};
use sscc_io::Setting;
use sscc_tasks::{Stage, Watch};

use crate::flags;
use crate::interrupt;
use crate::meter::Meter;
use crate::output;
use crate::progress::Bar;

/// Shows the progress of the current stage, and cancels the work on an interrupt.
#[derive(Default)]
pub struct Stages {
    indicator: Mutex<Option<Indicator>>,
}

enum Indicator {
    Bar(Bar),
    Meter(Meter),
}

impl Stages {
    fn show(&self, indicator: Option<Indicator>) {
        let mut current = self.indicator.lock().unwrap_or_else(PoisonError::into_inner);
        // Dropping the previous bar clears it from the screen.
        *current = None;
        *current = indicator;
    }

    /// Writes text beside the indicator.
    fn write(&self, write: impl FnOnce()) {
        match &*self.indicator.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(Indicator::Bar(bar)) => bar.suspend(write),
            Some(Indicator::Meter(meter)) => meter.suspend(write),
            None => write(),
        }
    }
}

impl Progress for Stages {
    fn report(&self, done: usize, total: usize) {
        match &*self.indicator.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(Indicator::Bar(bar)) => bar.report(done, total),
            Some(Indicator::Meter(meter)) => meter.report(done, total),
            None => {}
        }
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(interrupt::token())
    }
}

impl Watch for Stages {
    fn begin(&self, stage: Stage) {
        self.show(match stage {
            Stage::Solid => Some(Indicator::Bar(Bar::new("solid"))),
            Stage::Modes => Some(Indicator::Bar(Bar::new("modes"))),
            Stage::Certificates => Some(Indicator::Bar(Bar::new("certifying"))),
            Stage::Steps { step } => Some(Indicator::Meter(Meter::new(step))),
            Stage::Reading => Some(Indicator::Bar(Bar::new("reading"))),
            Stage::Detection => Some(Indicator::Bar(Bar::new("checking").beside_output())),
            Stage::Comparison => Some(Indicator::Bar(Bar::new("measuring"))),
            _ => None,
        });
    }

    fn note(&self, note: &str) {
        self.write(|| output::note(note));
    }

    fn inform(&self, line: &str) {
        self.note(line);
    }

    fn warn(&self, warning: &str) {
        self.write(|| output::warn_line(warning));
    }

    fn name(&self, setting: Setting) -> String {
        flags::flag(setting)
    }
}
