//! The threads of the program.

use anyhow::Context;
use rayon::ThreadPoolBuilder;

/// Starts the threads that all commands share: one for each core, or a single one if the system refuses so many. Without this
/// function, a command could end by a panic in the middle of its work.
///
/// # Errors
/// When the system refuses even one thread.
pub fn begin() -> anyhow::Result<()> {
    // rayon builds its global pool only once, even if that fails, so another pool of as many threads is built first.
    let count = if is_granted(ThreadPoolBuilder::new()) { 0 } else { 1 };
    ThreadPoolBuilder::new().num_threads(count).build_global().context(
        "the system refuses threads: free memory, or allow more memory or processes (ulimit -v, ulimit -u)",
    )
}

/// Whether the system grants the threads of a pool. They have ended when the function returns.
fn is_granted(pool: ThreadPoolBuilder) -> bool {
    pool.build_scoped(|thread| thread.run(), |_| ()).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stack of a thread, larger than any address space (bytes).
    const TOO_LARGE: usize = (isize::MAX as usize >> 16) << 16;

    #[test]
    fn threads_that_the_system_refuses_are_not_granted() {
        let two = || ThreadPoolBuilder::new().num_threads(2);
        assert!(is_granted(two()));
        assert!(!is_granted(two().stack_size(TOO_LARGE)));
    }
}
