//! Progress of long computations.

use crate::CancelToken;

/// Receives the progress of a long computation, and may give the token that cancels it. Several threads may call it.
pub trait Progress: Sync {
    /// Receives the report that `done` of `total` steps are finished. Threads may report out of order.
    fn report(&self, done: usize, total: usize);

    /// Returns the token that cancels the computation, which then ends soon with [`Error::Cancelled`](crate::Error::Cancelled).
    /// None by default.
    fn cancel_token(&self) -> Option<&CancelToken> {
        None
    }

    /// Whether the computation should end, because its token is cancelled.
    fn is_cancelled(&self) -> bool {
        self.cancel_token().is_some_and(CancelToken::is_cancelled)
    }
}

/// Ignores progress.
impl Progress for CancelToken {
    fn report(&self, _done: usize, _total: usize) {}

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(self)
    }
}

/// Ignores progress and never cancels.
impl Progress for () {
    fn report(&self, _done: usize, _total: usize) {}
}
