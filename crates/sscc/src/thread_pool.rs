//! Parallel work on a given number of threads.

/// Runs `work` in a pool of `threads` threads (none: all cores).
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(), // the system grants no more threads: `work` uses the global pool
    }
}
