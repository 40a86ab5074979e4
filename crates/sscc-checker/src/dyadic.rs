//! Numbers `m 2^e` with an integer m of any length: sums and products are exact, and every finite f64 is such a number.

use std::cmp::Ordering;
use std::iter::Sum;
use std::ops::{Add, Mul, Sub};

use dashu_int::ops::{BitTest, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};

/// A number `m 2^e`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Dyadic {
    mantissa: IBig,
    exponent: i64,
}

/// The smallest number of binary digits of roots.
const ROOT_BITS: usize = 64;

impl Dyadic {
    pub(crate) fn new(mantissa: i64, exponent: i64) -> Self {
        Self { mantissa: mantissa.into(), exponent }
    }

    /// Returns the exact value of a finite number, and 0 for other numbers. Only the node maps of a proof, which may be any, and
    /// computed positions at a huge centre are not finite: their distance from the exact positions is measured after this.
    pub(crate) fn of(x: f64) -> Self {
        if x == 0.0 || !x.is_finite() {
            return Self::default();
        }
        let (biased, fraction) = (x.abs().to_bits() >> 52, x.to_bits() & ((1 << 52) - 1));
        let mantissa = if biased == 0 { fraction } else { fraction | 1 << 52 };
        // Trailing zeros are removed, because short mantissas make short products.
        let zeros = mantissa.trailing_zeros();
        let mantissa = IBig::from(mantissa >> zeros);
        let exponent = biased.max(1) as i64 - 1075 + i64::from(zeros);
        Self { mantissa: if x < 0.0 { -mantissa } else { mantissa }, exponent }
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    pub(crate) fn is_positive(&self) -> bool {
        self.mantissa > IBig::ZERO
    }

    pub(crate) fn abs(&self) -> Self {
        Self { mantissa: self.mantissa.clone().unsigned_abs().into(), exponent: self.exponent }
    }

    /// Returns the smallest e such that the magnitude of this number is less than `2^e`; the smallest integer for 0.
    pub(crate) fn magnitude(&self) -> i64 {
        if self.is_zero() { i64::MIN } else { self.mantissa.bit_len() as i64 + self.exponent }
    }

    /// Returns about the size in memory, in bytes.
    pub(crate) fn size(&self) -> usize {
        size_of::<Self>() + self.mantissa.bit_len() / 8
    }

    /// Returns the number times a power of two.
    pub(crate) fn times_power(&self, power: i64) -> Self {
        Self { mantissa: self.mantissa.clone(), exponent: self.exponent + power }
    }

    /// Replaces this number by another one if the other one is larger.
    pub(crate) fn raise(&mut self, other: Self) {
        if other > *self {
            *self = other;
        }
    }

    pub(crate) fn square(&self) -> Self {
        self * self
    }

    /// Returns a number of at most `bits` significant binary digits that is at least this one, which must not be
    /// negative.
    pub(crate) fn round_up(&self, bits: usize) -> Self {
        let cut = self.mantissa.bit_len().saturating_sub(bits);
        if cut == 0 {
            return self.clone();
        }
        Self { mantissa: (&self.mantissa >> cut) + IBig::ONE, exponent: self.exponent + cut as i64 }
    }

    /// Returns an upper bound of the root of a non-negative number, too large by a relative error of less than 2^-60.
    pub(crate) fn root_up(&self) -> Self {
        if !self.is_positive() {
            return Self::default();
        }
        let Self { mantissa, exponent } = self.round_up(2 * ROOT_BITS);
        let mut shift = (2 * ROOT_BITS).saturating_sub(mantissa.bit_len());
        shift += (exponent - shift as i64).rem_euclid(2) as usize;
        let shifted: UBig = (mantissa << shift).unsigned_abs();
        let mut root = shifted.sqrt() + UBig::ONE;
        // This never happens. With it, the bound does not depend on the crate's roots.
        while &root * &root < shifted {
            root <<= 1;
        }
        Self { mantissa: root.into(), exponent: (exponent - shift as i64) / 2 }
    }

    /// Returns the quotient by a positive number, rounded towards 0 to a multiple of `2^exponent`.
    pub(crate) fn divided_by(&self, divisor: &Self, exponent: i64) -> Self {
        let shift = self.exponent - divisor.exponent - exponent;
        let (up, down) = (shift.max(0) as usize, shift.min(0).unsigned_abs() as usize);
        Self { mantissa: (&self.mantissa << up) / (&divisor.mantissa << down), exponent }
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;
    fn add(self, other: Self) -> Dyadic {
        if self.is_zero() || other.is_zero() {
            return if self.is_zero() { other } else { self }.clone();
        }
        let (high, low) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let shift = (high.exponent - low.exponent) as usize;
        Dyadic { mantissa: (&high.mantissa << shift) + &low.mantissa, exponent: low.exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;
    fn sub(self, other: Self) -> Dyadic {
        self + &Dyadic { mantissa: -&other.mantissa, exponent: other.exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;
    fn mul(self, other: Self) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl Sum for Dyadic {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::default(), |sum, x| &sum + &x)
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        (self - other).is_zero()
    }
}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some((self - other).mantissa.cmp(&IBig::ZERO))
    }
}

/// Returns `a . b` for two rows.
pub(crate) fn dot(a: &[Dyadic], b: &[Dyadic]) -> Dyadic {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the sum of the squares of a row.
pub(crate) fn squared_norm(row: &[Dyadic]) -> Dyadic {
    row.iter().map(Dyadic::square).sum()
}

/// A vector of three numbers.
pub(crate) type Vector = [Dyadic; 3];

pub(crate) fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|c| &a[c] - &b[c])
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|c| {
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        &(&a[d] * &b[e]) - &(&a[e] * &b[d])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_are_exact() {
        let numbers = [0.0, 1.0, -0.1, 1e300, -3e-310, f64::MIN_POSITIVE, 5e-324, 0.75];
        for x in numbers {
            for y in numbers {
                let (a, b) = (Dyadic::of(x), Dyadic::of(y));
                assert_eq!(a.partial_cmp(&b), x.partial_cmp(&y), "{x} {y}");
                assert_eq!(&(&a + &b) - &b, a);
                let sum = |numbers: [&Dyadic; 3]| numbers.into_iter().cloned().sum::<Dyadic>();
                let negative = &Dyadic::default() - &a;
                assert_eq!(sum([&a, &b, &a]), &(&a + &b) + &a);
                assert_eq!(sum([&a, &negative, &b]), b);
                assert_eq!(&(&a + &b).square() - &(&a - &b).square(), (&a * &b).times_power(2));
            }
        }
        // The exact sum of the f64 0.1 and 0.2 differs from the f64 nearest to it.
        assert_ne!(&Dyadic::of(0.1) + &Dyadic::of(0.2), Dyadic::of(0.1 + 0.2));
    }

    #[test]
    fn roots_and_rounded_numbers_are_tight_upper_bounds() {
        for x in [2.0, 4.0, 1e-320, 3e300, 0.1, 1.0 + f64::EPSILON] {
            for exact in [Dyadic::of(x), Dyadic::of(x).square(), &Dyadic::of(x).square() + &Dyadic::of(x)] {
                let root = exact.root_up();
                let larger = &root * &Dyadic::new((1 << 58) - 1, -58);
                assert!(root.square() > exact && larger.square() < exact, "{x}");
                let rounded = exact.round_up(20);
                assert!(rounded >= exact && rounded <= &exact * &Dyadic::of(1.0 + 1e-5));
            }
        }
        assert!(Dyadic::default().root_up().is_zero());
    }

    #[test]
    fn quotients_are_rounded_towards_0() {
        for (x, divisor, exponent, quotient) in [
            (1.0, 3.0, -64, ((1_i128 << 64) / 3) as f64 / 2_f64.powi(64)),
            (-7.0, 2.0, 0, -3.0),
            (7.0, 2.0, -1, 3.5),
            (1e300, 1.0, 1000, 0.0),
            (-11.0, 0.25, 3, -40.0),
        ] {
            let found = Dyadic::of(x).divided_by(&Dyadic::of(divisor), exponent);
            // The first quotient has more digits than an f64.
            let missing = (&found - &Dyadic::of(quotient)).abs();
            assert!(missing.is_zero() || missing < Dyadic::new(1, -54), "{x} / {divisor}");
            assert!(found.is_zero() || found.magnitude() > exponent, "{x} / {divisor}");
        }
    }

    #[test]
    fn magnitudes_are_the_next_powers_of_two() {
        for (x, magnitude) in [(1.0, 1), (-1.0, 1), (0.99, 0), (3.0, 2), (5e-324, -1073), (-1e300, 997)] {
            assert_eq!(Dyadic::of(x).magnitude(), magnitude, "{x}");
        }
        assert_eq!(Dyadic::default().times_power(300).magnitude(), i64::MIN);
    }
}
