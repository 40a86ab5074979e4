//! The options of an audit.

/// How many attacks an audit makes, and which.
#[derive(Clone, Copy, Debug)]
pub struct AuditOptions {
    /// Number of configurations q.
    pub samples: usize,
    /// Seed of the pseudo-random numbers: the same seed gives the same attacks.
    pub seed: u64,
    /// Number of threads; none: all cores. The report is the same for any number.
    pub threads: Option<usize>,
}

impl Default for AuditOptions {
    fn default() -> Self {
        Self { samples: 10_000, seed: 1, threads: None }
    }
}
