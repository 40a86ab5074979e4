//! Pseudo-random numbers: SplitMix64. A seed gives the same numbers on every machine.

/// A pseudo-random generator.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Creates the generator of one configuration of a path.
    pub fn new(path: &str, seed: u64) -> Self {
        let salt = path
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
        let mut random = Self(salt ^ seed.wrapping_mul(0xd6e8_feb8_6659_fd93));
        random.bits();
        random
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Returns a number in 0 .. n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n.max(1) as u64) as usize
    }

    /// Returns true once in n times, on average.
    pub fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// Returns one of some values.
    pub fn of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// Returns `10^x` with x between two exponents.
    pub fn power(&mut self, from: f64, to: f64) -> f64 {
        10.0_f64.powf(from + (to - from) * self.unit())
    }

    /// Returns a random point in the cube [-1, 1)^3.
    pub fn point(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.signed())
    }

    /// Returns an integer from -size to size.
    pub fn whole(&mut self, size: usize) -> f64 {
        self.below(2 * size + 1) as f64 - size as f64
    }

    /// Returns a number that is roughly normally distributed.
    pub fn normal(&mut self) -> f64 {
        self.signed() + self.signed() + self.signed()
    }
}
