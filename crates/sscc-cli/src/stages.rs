//! Bars of work that has several stages, one after the other, and its notes.

use std::sync::{Mutex, PoisonError};

use sscc::Progress;
use sscc_sim::{Stage, Watch};

use crate::interrupt;
use crate::meter::Meter;
use crate::output;
use crate::progress::Bar;

/// Shows the stage at work, and stops all of them on Ctrl-C.
#[derive(Default)]
pub struct Stages {
    shown: Mutex<Option<Shown>>,
}

enum Shown {
    Bar(Bar),
    Meter(Meter),
}

impl Stages {
    fn show(&self, shown: Option<Shown>) {
        // The bar before it is cleared first.
        let mut now = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        *now = None;
        *now = shown;
    }
}

impl Progress for Stages {
    fn report(&self, done: usize, total: usize) {
        match &*self.shown.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(Shown::Bar(bar)) => bar.report(done, total),
            Some(Shown::Meter(meter)) => meter.report(done, total),
            None => {}
        }
    }

    fn is_cancelled(&self) -> bool {
        interrupt::happened()
    }
}

impl Watch for Stages {
    fn begin(&self, stage: Stage) {
        self.show(match stage {
            Stage::Solid => Some(Shown::Bar(Bar::new("solid"))),
            Stage::Modes => Some(Shown::Bar(Bar::new("modes"))),
            Stage::Certificates => Some(Shown::Bar(Bar::new("certifying"))),
            Stage::Steps { step } => Some(Shown::Meter(Meter::new(step))),
            Stage::Comparison => Some(Shown::Bar(Bar::new("measuring"))),
            _ => None,
        });
    }

    fn note(&self, note: &str) {
        self.show(None);
        output::note(note);
    }
}
