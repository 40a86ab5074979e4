//! Cancellation of requests that take long.

use std::sync::Arc;

use sscc::{CancelToken, Error, Progress};

use crate::ViewError;

/// Time limit of a search along a direction, and of a sweep (s). At the limit a search returns its result so far; a sweep has
/// none.
pub(super) const MAX_SECONDS: u64 = 10;

/// Cancels work at its time limit, if its client has left or has sent a newer request, or if the server ends. Each of
/// these conditions stays true.
pub(super) struct Cancellation {
    pub(super) token: CancelToken,
    conditions: Arc<Conditions>,
}

struct Conditions {
    server: Option<CancelToken>,
    is_over: Box<dyn Fn() -> bool + Send + Sync>,
    is_wanted: Box<dyn Fn() -> bool + Send + Sync>,
}

impl Cancellation {
    /// Creates the cancellation of a request. `server` is the token of the server.
    pub(super) fn new(
        server: Option<CancelToken>,
        is_over: impl Fn() -> bool + Send + Sync + 'static,
        is_wanted: impl Fn() -> bool + Send + Sync + 'static,
    ) -> Self {
        let conditions =
            Arc::new(Conditions { server, is_over: Box::new(is_over), is_wanted: Box::new(is_wanted) });
        let shared = Arc::clone(&conditions);
        let is_cancelled = move || {
            let Conditions { server, is_over, is_wanted } = &*shared;
            server.as_ref().is_some_and(CancelToken::is_cancelled) || !is_wanted() || is_over()
        };
        Self { token: CancelToken::when(is_cancelled), conditions }
    }

    /// Whether the client still waits for this request.
    pub(super) fn is_wanted(&self) -> bool {
        (self.conditions.is_wanted)()
    }

    /// Whether the time limit is reached.
    pub(super) fn is_over(&self) -> bool {
        (self.conditions.is_over)()
    }

    /// Returns the error of a request; for a cancelled request its message names the reason.
    pub(super) fn explain(&self, error: Error) -> ViewError {
        match error {
            Error::Cancelled if !self.is_wanted() => {
                ViewError::Request("a newer search replaced this one before it had a result".into())
            }
            Error::Cancelled if self.is_over() => {
                ViewError::Request(format!("the search had no result within {MAX_SECONDS} s"))
            }
            error => error.into(),
        }
    }
}

impl Progress for Cancellation {
    fn report(&self, _done: usize, _total: usize) {}

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.token)
    }
}
