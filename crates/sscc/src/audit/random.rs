//! Streams of pseudo-random numbers of an audit.

use crate::random;

/// A stream of pseudo-random numbers.
#[derive(Clone, Debug)]
pub(super) struct Random(u64);

impl Random {
    /// Creates the stream number `stream` of a seed.
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut this = Self(seed ^ stream.wrapping_mul(0xd1b5_4a32_d192_ed03));
        random::next_bits(&mut this.0);
        this
    }

    /// Returns a number uniform in [0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        random::next_uniform(&mut self.0)
    }

    /// Returns a number uniform in 0 .. n.
    pub(super) fn below(&mut self, n: usize) -> usize {
        ((self.uniform() * n as f64) as usize).min(n.saturating_sub(1))
    }

    /// Returns `count` numbers of [`Random::normal`].
    pub(super) fn normals(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.normal()).collect()
    }

    /// Returns an approximately normal number of mean 0 and variance 1: a sum of twelve uniform numbers, which needs no library
    /// functions and so has the same bits on every machine.
    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}
