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

#[cfg(test)]
mod tests {
    use sscc_testing::Dyadic;

    use super::*;
    use crate::test_models::Random;

    fn exact(x: f64) -> Dyadic {
        Dyadic::new(x)
    }

    /// Returns 0, or a number of at most `10^widest`, with no error or one of up to ten times its size.
    fn number(random: &mut Random, widest: f64) -> BoundedFloat {
        if random.below(8) == 0 {
            return BoundedFloat::zero();
        }
        let value = random.signed() * random.power(-widest, widest);
        let error = if random.below(4) == 0 { 0.0 } else { value.abs() * random.power(-17.0, 1.0) };
        BoundedFloat { value, error }
    }

    /// Error bounds are at least the sum of the errors of operands, to second order, and of the rounding. They exceed
    /// it by no more than a few roundings and what covers underflow.
    #[test]
    fn errors_are_those_of_both_operands_and_of_the_rounding() {
        let random = &mut Random(1);
        for case in 0..1_500 {
            let widest = [0.0, 20.0, 150.0][case % 3];
            let (x, y) = (number(random, widest), number(random, widest));
            let ((a, e), (b, f)) = ((exact(x.value), exact(x.error)), (exact(y.value), exact(y.error)));
            for (found, value, of_operands) in [
                (x.plus(&y), &a + &b, &e + &f),
                (x.minus(&y), &a - &b, &e + &f),
                (x.times(&y), &a * &b, a.abs() * &f + b.abs() * &e + &e * &f),
                (BoundedFloat::difference(x.value, y.value), &a - &b, exact(0.0)),
            ] {
                let error = exact(found.error);
                let off = (exact(found.value) - value).abs();
                assert!(error >= off + &of_operands, "case {case}: {x:?} {y:?} {found:?}");
                let least = of_operands + exact(U) * exact(found.value.abs());
                let most = &least * exact(1.0 + 64.0 * U) + exact(2.0 * f64::MIN_POSITIVE);
                assert!(least <= error && error <= most, "case {case}: {x:?} {y:?} {found:?}");
            }
        }
    }

    /// A number that is as far from 0 as its error bound may be 0, which is not positive.
    #[test]
    fn only_numbers_beyond_their_error_are_positive() {
        for error in [0.0, f64::MIN_POSITIVE, 1.0] {
            let sign = |value: f64| BoundedFloat { value, error }.is_positive();
            assert_ne!(sign(error), Some(true), "{error}");
            assert_eq!([error.next_up(), -error.next_up()].map(sign), [Some(true), Some(false)], "{error}");
        }
    }

    /// The lower bound is that of the smallest number and the largest square, the upper bound that of the other ends.
    #[test]
    fn quotients_by_roots_are_those_of_the_ends() {
        let random = &mut Random(2);
        let (share, zero) = (exact(1.0 + 64.0 * U), exact(0.0));
        for case in 0..1_000 {
            let x = BoundedFloat {
                value: random.signed() * random.power(-9.0, 9.0),
                error: random.power(-12.0, 9.0),
            };
            let value = random.power(-9.0, 9.0);
            let square = BoundedFloat { value, error: value * random.power(-17.0, 0.3) };
            let Bounds { lower, upper } = x.over_root(&square);
            let ends = [exact(x.value) - exact(x.error), exact(x.value) + exact(x.error)];
            let [least, most] = ends.map(|end| if end > zero { &end * &end } else { zero.clone() });
            let (s, e) = (exact(square.value), exact(square.error));
            let below = exact(lower) * exact(lower) * (&s + &e);
            assert!(below <= least && least <= &below * &share, "case {case}: {x:?} {square:?} {lower}");
            if s > e {
                let above = exact(upper) * exact(upper) * (&s - &e);
                assert!(above >= most && above <= &most * &share, "case {case}: {x:?} {square:?} {upper}");
            } else {
                assert_eq!(upper, f64::INFINITY, "case {case}: {x:?} {square:?}");
            }
        }
    }
}
