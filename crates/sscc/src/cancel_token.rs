//! Cancellation of queries and long computations.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Ends queries and long computations early: from another thread, at a signal, at a deadline. Clones are the same token.
///
/// ```
/// use sscc::CancelToken;
///
/// let token = CancelToken::new();
/// let other = token.clone();
/// std::thread::spawn(move || other.cancel()).join().unwrap();
/// assert!(token.is_cancelled());
/// ```
#[derive(Clone, Default)]
pub struct CancelToken(Arc<Shared>);

#[derive(Default)]
struct Shared {
    is_cancelled: AtomicBool,
    condition: Option<Box<dyn Fn() -> bool + Send + Sync>>,
}

impl CancelToken {
    /// Creates a token that [`CancelToken::cancel`] cancels.
    pub fn new() -> Self {
        Self::default()
    }

    /// Creates a token that is also cancelled as soon as a condition holds, for example after a time limit. Several threads
    /// evaluate the condition often. It must stay true while work has this token: otherwise work that it ended early would seem
    /// complete.
    pub fn when(condition: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        Self(Arc::new(Shared { condition: Some(Box::new(condition)), ..Shared::default() }))
    }

    /// Cancels all work that has this token.
    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the work should end.
    pub fn is_cancelled(&self) -> bool {
        self.0.is_cancelled.load(Ordering::Relaxed)
            || self.0.condition.as_ref().is_some_and(|condition| condition())
    }
}

impl fmt::Debug for CancelToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("CancelToken").field(&self.0.is_cancelled).finish()
    }
}
