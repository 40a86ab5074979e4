//! Cancellation of requests that take long.

use sscc::{Error, Progress};

use crate::ViewError;

/// Time limit of a search along a direction (s), which then ends with its result until then, and of a sweep, which has none.
pub(super) const MAX_SECONDS: u64 = 10;

/// Cancels work at its time limit, if its client has left or has sent a newer request, or if the server ends. Each of
/// these conditions stays true.
pub(super) struct Cancellation<'a> {
    /// The progress of the server.
    pub(super) server: &'a dyn Progress,
    pub(super) is_over: &'a (dyn Fn() -> bool + Sync),
    pub(super) is_wanted: &'a (dyn Fn() -> bool + Sync),
}

impl Cancellation<'_> {
    /// Returns the error of a request; for a cancelled request its message names the reason.
    pub(super) fn explain(&self, error: Error) -> ViewError {
        match error {
            Error::Cancelled if !(self.is_wanted)() => {
                ViewError::Request("a newer search replaced this one before it had a result".into())
            }
            Error::Cancelled if (self.is_over)() => {
                ViewError::Request(format!("the search had no result within {MAX_SECONDS} s"))
            }
            error => error.into(),
        }
    }
}

impl Progress for Cancellation<'_> {
    fn report(&self, _done: usize, _total: usize) {}

    fn is_cancelled(&self) -> bool {
        self.server.is_cancelled() || !(self.is_wanted)() || (self.is_over)()
    }
}
