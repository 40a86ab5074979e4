//! The options of an audit.

/// The number of attacks of an audit, the seed and the number of threads. Each method sets one option:
/// `AuditOptions::default().samples(100)`.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct AuditOptions {
    pub(super) samples: usize,
    pub(super) seed: u64,
    pub(super) threads: Option<usize>,
}

impl Default for AuditOptions {
    fn default() -> Self {
        Self { samples: 10_000, seed: 1, threads: None }
    }
}

impl AuditOptions {
    setters! {
        /// Number of attacks, each at one configuration q or two. Comparisons of methods come in addition, one for
        /// every 50 attacks, but at least one and at most 200. Any number takes the same memory, but time without a limit: give the
        /// audit a token that cancels. 10,000 by default.
        samples: usize,
        /// Seed of the pseudo-random numbers: the same seed gives the same attacks. 1 by default.
        seed: u64,
        /// Number of threads, `None` for all cores. The report is the same for any number.
        threads: impl Into<Option<usize>>,
    }
}
