//! Cancellation of computations of modes.

use sscc::{Error, Progress};

/// Checks whether the work is cancelled.
///
/// # Errors
/// When the work is cancelled.
pub(crate) fn check_cancelled(progress: &dyn Progress) -> Result<(), Error> {
    if progress.is_cancelled() { Err(Error::Cancelled) } else { Ok(()) }
}
