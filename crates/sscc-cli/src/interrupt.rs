//! Interrupts: Ctrl-C (SIGINT) and SIGTERM. The first one asks the work at hand to stop, the second one ends the program.
//!
//! SIGHUP is left alone: `nohup` ignores it, and a handler would undo that.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use anyhow::bail;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::outcome::EXIT_INTERRUPTED;

/// The one word for every interrupt, which is also that of [`sscc::Error::Cancelled`].
const INTERRUPTED: &str = "interrupted";

static HAPPENED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Listens from now on.
pub fn listen() {
    for signal in [SIGINT, SIGTERM] {
        // In this order: only an interrupt that comes after another one finds the flag set. Without a handler the
        // signal ends the program at once, which is safe too: files appear whole or not at all.
        let _ = flag::register_conditional_shutdown(signal, EXIT_INTERRUPTED.into(), Arc::clone(&HAPPENED));
        let _ = flag::register(signal, Arc::clone(&HAPPENED));
    }
}

/// Whether there was an interrupt.
pub fn happened() -> bool {
    HAPPENED.load(Ordering::Relaxed)
}

/// Cancels queries on an interrupt.
pub struct Interrupt;

impl sscc::Progress for Interrupt {
    fn report(&self, _done: usize, _total: usize) {}

    fn is_cancelled(&self) -> bool {
        happened()
    }
}

/// Stops here if there was an interrupt.
pub fn check() -> anyhow::Result<()> {
    if happened() {
        bail!(INTERRUPTED);
    }
    Ok(())
}

/// An error on one line. Of work that an interrupt stopped it is that word (and what follows it), not where the work
/// was: that is the same for all commands.
pub fn message(error: &anyhow::Error) -> String {
    let root = error.root_cause().to_string();
    if root.starts_with(INTERRUPTED) { root } else { crate::output::one_line(&format!("{error:#}")) }
}
