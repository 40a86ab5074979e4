//! Ctrl-C: the first one asks the work at hand to stop, the second one ends the program.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::bail;

use crate::EXIT_INTERRUPTED;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Listens from now on.
pub fn listen() {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            process::exit(EXIT_INTERRUPTED.into());
        }
    };
    // Without a handler Ctrl-C ends the program at once, which is safe too: files appear whole or not at all.
    let _ = ctrlc::set_handler(handler);
}

/// Whether Ctrl-C was pressed.
pub fn happened() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// For programs that hear of Ctrl-C by themselves.
pub fn set(happened: bool) {
    INTERRUPTED.store(happened, Ordering::Relaxed);
}

/// Cancels queries on Ctrl-C.
pub struct Interrupt;

impl sscc::Progress for Interrupt {
    fn report(&self, _done: usize, _total: usize) {}

    fn is_cancelled(&self) -> bool {
        happened()
    }
}

/// Stops here if Ctrl-C was pressed.
pub fn check() -> anyhow::Result<()> {
    if happened() {
        bail!("interrupted");
    }
    Ok(())
}
