//! The threads of the program.

use anyhow::Context;
use rayon::ThreadPoolBuilder;

/// Starts the threads that all commands share: one for each core, or only the current one if the system refuses others.
/// Without this function, a command could end by a panic in the middle of its work.
pub fn begin() -> anyhow::Result<()> {
    let all = ThreadPoolBuilder::new().build_global();
    all.or_else(|_| ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()).context(
        "the system refuses threads: free memory, or allow more memory or processes (ulimit -v, ulimit -u)",
    )
}
