//! Doubles with a running error bound, for the filter of polynomial predicates.

use glam::DVec3;

use super::number::{Bounds, Number};

/// A double and an upper bound of its difference from the exact number. An overflow makes the error bound infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoundedFloat {
    pub(super) value: f64,
    pub(super) error: f64,
}

/// `u = 2^-53`: half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

impl BoundedFloat {
    /// Returns a `value` that was rounded once. `error`: the error from its operands, a sum of positive terms that was
    /// itself rounded at most four times, each time by at most `u` of it. `8 u` covers these roundings and those of
    /// this function. Underflow adds less than 2^-1070 in all.
    #[inline]
    fn rounded(value: f64, error: f64) -> Self {
        let rounding = with_mutant!(U, BoundedExact, 0.0) * value.abs();
        let error = (error + rounding) * (1.0 + 8.0 * U) + f64::MIN_POSITIVE;
        if error.is_finite() { Self { value, error } } else { Self { value: 0.0, error: f64::INFINITY } }
    }
}

impl Number for BoundedFloat {
    fn zero() -> Self {
        Self { value: 0.0, error: 0.0 }
    }

    fn from_f64(x: f64) -> Self {
        Self { value: x, error: 0.0 }
    }

    fn difference(a: f64, b: f64) -> Self {
        Self::rounded(a - b, 0.0)
    }

    #[inline]
    fn plus(&self, other: &Self) -> Self {
        Self::rounded(self.value + other.value, self.error + other.error)
    }

    #[inline]
    fn minus(&self, other: &Self) -> Self {
        Self::rounded(self.value - other.value, self.error + other.error)
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        let error = self.value.abs() * other.error + (other.value.abs() + other.error) * self.error;
        Self::rounded(self.value * other.value, error)
    }

    /// Each number differs from its value by at most its error, so their minimum differs by at most the larger error.
    #[inline]
    fn minimum(&self, other: &Self) -> Self {
        let error = with_mutant!(self.error.max(other.error), SmallerErrorOfTwo, self.error.min(other.error));
        Self { value: self.value.min(other.value), error }
    }

    #[inline]
    fn is_positive(&self) -> Option<bool> {
        if self.value > self.error {
            Some(true)
        } else if self.value < -self.error {
            Some(false)
        } else {
            None
        }
    }

    fn over_root(&self, square: &Self) -> Bounds {
        let root = |square: f64| square.max(0.0).sqrt();
        let lower = (self.value - self.error).max(0.0) / root(square.value + square.error) * (1.0 - 8.0 * U);
        let upper = (self.value + self.error).max(0.0) / root(square.value - square.error) * (1.0 + 8.0 * U);
        // 0 / 0 and infinity / infinity are NaN: then the bounds are 0 and infinity.
        Bounds {
            lower: if lower.is_finite() { lower } else { 0.0 },
            upper: if upper >= 0.0 { upper } else { f64::INFINITY },
        }
    }

    fn direction(dir: &[Self; 3]) -> DVec3 {
        DVec3::from_array(dir.map(|x| x.value))
    }
}
