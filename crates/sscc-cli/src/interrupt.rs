//! Handles interrupts: Ctrl-C (SIGINT) and SIGTERM. The first one cancels the running work, the second one ends the
//! program.
//!
//! SIGHUP has no handler: `nohup` ignores the signal, and a handler would undo that.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use sscc::CancelToken;

use crate::flags;
use crate::outcome::EXIT_INTERRUPTED;
use crate::output::one_line;

static INTERRUPTED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

static TOKEN: LazyLock<CancelToken> = LazyLock::new(|| CancelToken::when(is_interrupted));

/// Installs the signal handlers.
pub fn install_handlers() {
    for signal in [SIGINT, SIGTERM] {
        // In this order, only the second interrupt finds the flag set. If a handler cannot be installed, the signal
        // ends the program at once. That is safe, too, because files appear whole or not at all.
        let _ =
            flag::register_conditional_shutdown(signal, EXIT_INTERRUPTED.into(), Arc::clone(&INTERRUPTED));
        let _ = flag::register(signal, Arc::clone(&INTERRUPTED));
    }
}

/// Whether the program has received an interrupt.
pub fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// The token that an interrupt cancels.
pub fn token() -> &'static CancelToken {
    &TOKEN
}

/// Returns an error if the program has received an interrupt.
pub fn check() -> anyhow::Result<()> {
    if is_interrupted() {
        return Err(sscc::Error::Cancelled.into());
    }
    Ok(())
}

/// Returns an error as one line. For interrupted work the line has the root cause only, so that all commands print the
/// same message.
pub fn message(error: &anyhow::Error) -> String {
    message_of(error, is_interrupted())
}

fn message_of(error: &anyhow::Error, is_interrupted: bool) -> String {
    let root = flags::message(error.root_cause());
    if is_interrupted && root.starts_with("interrupted") {
        return one_line(&root);
    }
    let messages: Vec<String> = error.chain().map(flags::message).collect();
    one_line(&messages.join(": "))
}

#[cfg(test)]
mod tests {
    use anyhow::anyhow;

    use super::*;

    #[test]
    fn interrupted_work_has_no_context() {
        let error = || anyhow::Error::from(sscc::Error::Cancelled).context("the place");
        assert_eq!(message_of(&error(), true), "interrupted");
        // Names of files may begin with the same word.
        let other = anyhow!("interrupted.obj: not found").context("the place");
        assert_eq!(message_of(&other, false), "the place: interrupted.obj: not found");
    }
}
