//! Parallel work on a stated number of threads.

/// Runs work on so many threads (none: all cores).
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> T {
    match rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(), // no more threads to be had: the global pool serves as well
    }
}
