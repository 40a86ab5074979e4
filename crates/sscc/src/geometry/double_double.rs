//! Numbers of about 106 bits: unevaluated sums of two doubles (Dekker 1971).
//!
//! The algorithms and bounds are those of Joldes, Muller and Popescu (2017, *Tight and Rigorous Error Bounds for Basic
//! Building Blocks of Double-Word Arithmetic*), without fused multiply-add, with `u = 2^-53`. Nothing may overflow or
//! underflow.

use std::ops::{Add, Mul, Neg, Sub};

/// `hi + lo`, where `hi` is the double nearest to the sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// Returns `a - b`, exactly.
    #[inline]
    pub(super) fn difference(a: f64, b: f64) -> Self {
        two_sum(a, -b)
    }

    /// Returns the nearest double.
    #[inline]
    pub(super) fn to_f64(self) -> f64 {
        self.hi
    }

    /// Returns the magnitude.
    #[inline]
    pub(super) fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Returns the number times `2^exponent`, for exponents within 2000: exact unless it overflows or underflows.
    #[inline]
    pub(super) fn times_power_of_two(self, exponent: i32) -> Self {
        let times = |x| times_power_of_two(x, exponent);
        Self { hi: times(self.hi), lo: times(self.lo) }
    }
}

/// Returns `x 2^exponent` for exponents within 2000: exact unless it overflows or underflows.
///
/// It multiplies by two factors, since a power of two can be outside the range of f64 although the product is not.
#[inline]
pub(super) fn times_power_of_two(x: f64, exponent: i32) -> f64 {
    let power = |exponent: i32| f64::from_bits(((1023 + exponent) as u64) << 52);
    x * power(exponent / 2) * power(exponent - exponent / 2)
}

impl Neg for DoubleDouble {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for DoubleDouble {
    type Output = Self;

    /// Has a relative error of at most `3 u^2 / (1 - 4 u)` (algorithm 6).
    #[inline]
    fn add(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let v = fast_two_sum(s.hi, s.lo + t.hi);
        fast_two_sum(v.hi, t.lo + v.lo)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;

    /// Has a relative error of at most `7 u^2` (algorithm 10).
    #[inline]
    fn mul(self, other: Self) -> Self {
        let c = two_product(self.hi, other.hi);
        fast_two_sum(c.hi, c.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

/// Returns `a + b`, exactly.
#[inline]
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let part = hi - a;
    DoubleDouble { hi, lo: (a - (hi - part)) + (b - part) }
}

/// Returns `a + b`, exactly if the exponent of a is at least that of b, or a is 0.
#[inline]
fn fast_two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    DoubleDouble { hi, lo: b - (hi - a) }
}

/// Returns `a b`, exactly.
#[inline]
fn two_product(a: f64, b: f64) -> DoubleDouble {
    let ((a_hi, a_lo), (b_hi, b_lo)) = (halves(a), halves(b));
    let hi = a * b;
    DoubleDouble { hi, lo: a_lo * b_lo - (((hi - a_hi * b_hi) - a_lo * b_hi) - a_hi * b_lo) }
}

/// Returns two numbers of at most 26 bits with this sum (Veltkamp).
#[inline]
fn halves(x: f64) -> (f64, f64) {
    const SPLITTER: f64 = ((1_u64 << 27) + 1) as f64;
    let c = SPLITTER * x;
    let hi = c - (c - x);
    (hi, x - hi)
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::{Signed, Zero};

    use super::*;

    fn exact(x: DoubleDouble) -> BigRational {
        let exact = |x| BigRational::from_float(x).unwrap();
        exact(x.hi) + exact(x.lo)
    }

    #[test]
    fn operations_keep_their_error_bounds() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let exponent = (state >> 20) % 60;
            ((state >> 11) as f64 / 2.0_f64.powi(52) - 1.0) / (1_u64 << exponent) as f64
        };
        let u_squared = BigRational::from_float(2.0_f64.powi(-106)).unwrap();
        for _ in 0..2_000 {
            let [x, y] = [(); 2].map(|()| DoubleDouble::difference(random(), random()));
            // A number that almost cancels x.
            let z = DoubleDouble { hi: -x.hi, lo: x.lo };
            for y in [y, z] {
                let cases = [(x + y, exact(x) + exact(y), 4), (x * y, exact(x) * exact(y), 7)];
                for (found, expected, factor) in cases {
                    let error = (exact(found) - &expected).abs();
                    assert!(error <= expected.abs() * &u_squared * BigRational::from_integer(factor.into()));
                }
            }
            assert!((exact(x) - exact(x)).is_zero() && (x - x).to_f64() == 0.0);
        }
    }

    #[test]
    fn powers_of_two_reach_denormal_numbers() {
        let least = f64::from_bits(1);
        assert_eq!(times_power_of_two(least, 1074), 1.0);
        assert_eq!(times_power_of_two(1.0, -1074), least);
        assert_eq!(times_power_of_two(3.0, 200), 3.0 * 2.0_f64.powi(200));
    }
}
