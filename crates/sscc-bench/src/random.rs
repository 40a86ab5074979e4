//! Pseudo-random numbers, the same on every machine.

/// A generator with its state.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Returns a number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        sscc::parts::next_uniform(&mut self.0)
    }

    /// Returns a normally distributed number of mean 0 and variance 1 (Box and Muller).
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
    }
}
