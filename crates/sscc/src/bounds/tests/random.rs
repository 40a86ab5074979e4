//! Pseudo-random numbers of the tests.

use glam::DVec3;

use crate::random;

/// A stream of pseudo-random numbers, the same in every run.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut this = Self(seed.wrapping_mul(0xd1b5_4a32_d192_ed03));
        this.bits();
        this
    }

    fn bits(&mut self) -> u64 {
        random::next_bits(&mut self.0)
    }

    /// Returns a number in [0, 1).
    pub(crate) fn uniform(&mut self) -> f64 {
        random::next_uniform(&mut self.0)
    }

    /// Returns a number in 0 .. n.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Returns a vector whose components are in [-1, 1).
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.uniform(), self.uniform(), self.uniform()) * 2.0 - 1.0
    }

    /// Returns `10^x` for a random x between the two exponents.
    pub(crate) fn power(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * self.uniform())
    }

    /// Returns random barycentric weights.
    pub(crate) fn weights(&mut self) -> DVec3 {
        normalize(DVec3::new(self.uniform(), self.uniform(), self.uniform()))
    }
}

/// Returns barycentric weights from any vector: negative components become 0.
pub(super) fn normalize(w: DVec3) -> DVec3 {
    let w = w.max(DVec3::ZERO);
    let sum = w.x + w.y + w.z;
    if sum > 0.0 { w / sum } else { DVec3::X }
}
