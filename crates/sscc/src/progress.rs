//! Progress and cancellation of long computations.

/// Receives the progress of a long computation and can cancel it. Several threads call it.
pub trait Progress: Sync {
    /// Receives that `done` of `total` steps are finished. Threads may report out of order.
    fn report(&self, done: usize, total: usize);

    /// Whether the computation should end soon, with [`Error::Cancelled`](crate::Error::Cancelled). Once true, it must
    /// stay true.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Ignores progress and never cancels.
impl Progress for () {
    fn report(&self, _done: usize, _total: usize) {}
}
