//! The threads of the program.

use anyhow::Context;

/// Begins the threads that all commands share. Without this, a system that refuses them would end a command in the middle of its
/// work by a panic.
pub fn begin() -> anyhow::Result<()> {
    rayon::ThreadPoolBuilder::new().build_global().context(
        "the system refuses threads: free memory, or allow more memory or processes (ulimit -v, ulimit -u)",
    )
}
