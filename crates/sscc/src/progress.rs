//! Progress and cancellation of long work.

/// Told how far long work has come; may stop it. Called from several threads.
pub trait Progress: Sync {
    /// `done` of `total` steps are finished. Threads may report a little out of order.
    fn report(&self, done: usize, total: usize);

    /// Whether the work should stop soon, with [`Error::Cancelled`](crate::Error::Cancelled). Once true it
    /// must stay true.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Neither shows nor stops anything.
impl Progress for () {
    fn report(&self, _done: usize, _total: usize) {}
}
