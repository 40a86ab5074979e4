//! Exact numbers for polynomial predicates: integers times powers of two.

use glam::DVec3;
use num_bigint::{BigInt, Sign};

use super::number::{Bounds, Number, power_of_two};
use crate::geometry::binary64::Binary64;

/// `u = 2^-53`: half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

/// `mantissa * 2^exponent`: sums, differences and products are exact.
#[derive(Clone, Debug)]
pub(super) struct Dyadic {
    pub(super) mantissa: BigInt,
    pub(super) exponent: i64,
}

/// A rounded mantissa with the exponent that belongs to it.
#[derive(Clone, Copy)]
struct Leading {
    mantissa: f64,
    exponent: i64,
}

impl Dyadic {
    /// Returns the mantissa's leading 60 bits, rounded to a double.
    fn leading(&self) -> Leading {
        let excess = self.mantissa.bits().saturating_sub(60);
        let leading = i64::try_from(self.mantissa.magnitude() >> excess).unwrap_or(i64::MAX) as f64;
        let mantissa = if self.mantissa.sign() == Sign::Minus { -leading } else { leading };
        Leading { mantissa, exponent: self.exponent + excess as i64 }
    }
}

impl Number for Dyadic {
    fn zero() -> Self {
        Self { mantissa: BigInt::ZERO, exponent: 0 }
    }

    fn from_f64(x: f64) -> Self {
        let Binary64 { mantissa, exponent } = Binary64::of(x);
        // Removes trailing zeros, which would lengthen all products.
        let zeros = if mantissa == 0 { 0 } else { mantissa.trailing_zeros() };
        Self { mantissa: (mantissa >> zeros).into(), exponent: i64::from(exponent) - 1075 + i64::from(zeros) }
    }

    fn difference(a: f64, b: f64) -> Self {
        Self::from_f64(a).minus(&Self::from_f64(b))
    }

    fn plus(&self, other: &Self) -> Self {
        match (self.mantissa.sign(), other.mantissa.sign()) {
            (Sign::NoSign, _) => other.clone(),
            (_, Sign::NoSign) => self.clone(),
            _ => {
                let exponent = self.exponent.min(other.exponent);
                let aligned = |x: &Self| &x.mantissa << (x.exponent - exponent);
                Self { mantissa: aligned(self) + aligned(other), exponent }
            }
        }
    }

    fn minus(&self, other: &Self) -> Self {
        self.plus(&Self { mantissa: -&other.mantissa, exponent: other.exponent })
    }

    fn times(&self, other: &Self) -> Self {
        Self { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }

    fn minimum(&self, other: &Self) -> Self {
        if self.minus(other).mantissa.sign() == Sign::Minus { self } else { other }.clone()
    }

    fn is_positive(&self) -> Option<bool> {
        Some(self.mantissa.sign() == Sign::Plus)
    }

    fn over_root(&self, square: &Self) -> Bounds {
        if self.mantissa.sign() != Sign::Plus || square.mantissa.sign() != Sign::Plus {
            return Bounds { lower: 0.0, upper: 0.0 };
        }
        let (numerator, square) = (self.leading(), square.leading());
        // The root of a power of two needs an even exponent.
        let odd = square.exponent.rem_euclid(2);
        let root = (square.mantissa * power_of_two(odd)).sqrt();
        let quotient =
            numerator.mantissa / root * power_of_two(numerator.exponent - (square.exponent - odd) / 2);
        Bounds { lower: quotient * (1.0 - 64.0 * U), upper: quotient * (1.0 + 64.0 * U) }
    }

    fn direction(dir: &[Self; 3]) -> DVec3 {
        let parts = dir.each_ref().map(Self::leading);
        let nonzero = parts.iter().filter(|x| x.mantissa != 0.0);
        let largest = nonzero.map(|x| x.exponent).max().unwrap_or(0);
        DVec3::from_array(parts.map(|x| x.mantissa * power_of_two(x.exponent - largest)))
    }
}
