//! Two kinds of numbers for the same predicates: rounded ones that carry an error bound, and exact ones.
//!
//! A predicate is evaluated with [`Bounded`] numbers first; where their error bound leaves its sign undecided, it is
//! evaluated again with [`Dyadic`] ones. This is the usual filter of exact predicates, with the error bound computed
//! beside the value instead of proven for one expression.

use glam::DVec3;
use num_bigint::{BigInt, Sign};

use crate::geometry::decode;

/// The arithmetic of polynomial predicates.
pub(super) trait Number: Clone {
    /// Zero.
    fn zero() -> Self;

    /// The number that a double stands for.
    fn from_f64(x: f64) -> Self;

    /// The difference of two doubles.
    fn difference(a: f64, b: f64) -> Self;

    /// The sum.
    fn plus(&self, other: &Self) -> Self;

    /// The difference.
    fn minus(&self, other: &Self) -> Self;

    /// The product.
    fn times(&self, other: &Self) -> Self;

    /// The smaller of two numbers.
    fn minimum(&self, other: &Self) -> Self;

    /// Whether the number is above 0; none if the error bound leaves this undecided.
    fn is_positive(&self) -> Option<bool>;

    /// Lower and upper bound of `self / sqrt(square)`: their rounding is a few units in the last place beside the error
    /// bounds of both numbers. The lower bound of a number that is not provably positive is 0; where the square may be 0
    /// the bounds are 0 and infinity.
    fn over_root(&self, square: &Self) -> [f64; 2];

    /// A vector of the same direction, rounded.
    fn direction(n: &[Self; 3]) -> DVec3;
}

/// A double and a bound on its difference from the number that it stands for. An overflow makes the error bound infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounded {
    value: f64,
    error: f64,
}

/// `u = 2^-53`: half a unit in the last place of 1.
const U: f64 = f64::EPSILON / 2.0;

impl Bounded {
    /// A result that was rounded once, `value`, whose operands account for the error `error`. That sum of positive terms
    /// was itself rounded at most four times, each time by at most `u` of it; `8 u` covers these roundings and those
    /// of this line. Underflow adds less than 2^-1070 in all.
    #[inline]
    fn rounded(value: f64, error: f64) -> Self {
        let rounding = right_or!(U, BoundedExact, 0.0) * value.abs();
        let error = (error + rounding) * (1.0 + 8.0 * U) + f64::MIN_POSITIVE;
        if error.is_finite() { Self { value, error } } else { Self { value: 0.0, error: f64::INFINITY } }
    }
}

impl Number for Bounded {
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

    /// Neither number differs from its value by more than its error, so their minimum differs by no more than the larger
    /// error.
    #[inline]
    fn minimum(&self, other: &Self) -> Self {
        Self { value: self.value.min(other.value), error: self.error.max(other.error) }
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

    fn over_root(&self, square: &Self) -> [f64; 2] {
        let root = |square: f64| square.max(0.0).sqrt();
        let lower = (self.value - self.error).max(0.0) / root(square.value + square.error) * (1.0 - 8.0 * U);
        let upper = (self.value + self.error).max(0.0) / root(square.value - square.error) * (1.0 + 8.0 * U);
        // 0 / 0 and infinity / infinity are NaN: nothing is known then.
        [if lower.is_finite() { lower } else { 0.0 }, if upper >= 0.0 { upper } else { f64::INFINITY }]
    }

    fn direction(n: &[Self; 3]) -> DVec3 {
        DVec3::from_array(n.map(|n| n.value))
    }
}

/// `mantissa * 2^exponent`: sums, differences and products are exact.
#[derive(Clone, Debug)]
pub(super) struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    /// The mantissa's leading 60 bits, rounded to a double, and the exponent that belongs to them.
    fn leading(&self) -> (f64, i64) {
        let excess = self.mantissa.bits().saturating_sub(60);
        let leading = i64::try_from(self.mantissa.magnitude() >> excess).unwrap_or(i64::MAX) as f64;
        let signed = if self.mantissa.sign() == Sign::Minus { -leading } else { leading };
        (signed, self.exponent + excess as i64)
    }
}

impl Number for Dyadic {
    fn zero() -> Self {
        Self { mantissa: BigInt::ZERO, exponent: 0 }
    }

    fn from_f64(x: f64) -> Self {
        let (mantissa, exponent) = decode(x);
        // Short mantissas: trailing zeros would be carried through all products.
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

    fn over_root(&self, square: &Self) -> [f64; 2] {
        if self.mantissa.sign() != Sign::Plus || square.mantissa.sign() != Sign::Plus {
            return [0.0; 2];
        }
        let ((n, n_exponent), (d, d_exponent)) = (self.leading(), square.leading());
        // The root of a power of two needs an even exponent.
        let odd = d_exponent.rem_euclid(2);
        let root = (d * power_of_two(odd)).sqrt();
        let quotient = n / root * power_of_two(n_exponent - (d_exponent - odd) / 2);
        [quotient * (1.0 - 64.0 * U), quotient * (1.0 + 64.0 * U)]
    }

    fn direction(n: &[Self; 3]) -> DVec3 {
        let parts = n.each_ref().map(Self::leading);
        let nonzero = parts.iter().filter(|(leading, _)| *leading != 0.0);
        let largest = nonzero.map(|(_, exponent)| *exponent).max().unwrap_or(0);
        DVec3::from_array(parts.map(|(leading, exponent)| leading * power_of_two(exponent - largest)))
    }
}

/// `2^exponent`; 0 below the normal numbers, and no more than 2^1023.
pub(super) fn power_of_two(exponent: i64) -> f64 {
    match exponent {
        ..-1022 => 0.0,
        _ => f64::from_bits(((1023 + exponent.min(1023)) as u64) << 52),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::Signed;

    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).unwrap()
    }

    /// The number that a [`Dyadic`] stands for.
    fn value(x: &Dyadic) -> BigRational {
        let two = BigRational::from_integer(2.into());
        BigRational::from_integer(x.mantissa.clone()) * num_traits::Pow::pow(two, x.exponent as i32)
    }

    /// Random sums and products of random numbers of very different sizes: exact ones equal rational arithmetic,
    /// rounded ones differ from it by no more than their error bound, and neither tells a wrong sign.
    #[test]
    fn both_kinds_agree_with_rational_arithmetic() {
        let mut state = 1_u64;
        let mut random = |n: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % n
        };
        let double = |random: &mut dyn FnMut(u64) -> u64, widest: i64| {
            let fraction = random(1 << 31) as f64 / (1_u64 << 30) as f64 - 1.0;
            fraction * power_of_two(random(2 * widest as u64 + 1) as i64 - widest)
        };
        let (mut decided, mut open) = (0, 0);
        for case in 0..3_000 {
            let widest = if case % 2 == 0 { 8 } else { 300 };
            let (a, b) = (double(&mut random, widest), double(&mut random, widest));
            let mut numbers =
                (Bounded::difference(a, b), Dyadic::difference(a, b), rational(a) - rational(b));
            for _ in 0..6 {
                let (c, d) = (double(&mut random, widest), double(&mut random, widest));
                let (x, y, z) =
                    (Bounded::difference(c, d), Dyadic::difference(c, d), rational(c) - rational(d));
                numbers = match random(5) {
                    4 => (numbers.0.minimum(&x), numbers.1.minimum(&y), numbers.2.min(z)),
                    0 => (numbers.0.plus(&x), numbers.1.plus(&y), numbers.2 + z),
                    1 => (numbers.0.minus(&x), numbers.1.minus(&y), numbers.2 - z),
                    2 => (numbers.0.times(&x), numbers.1.times(&y), numbers.2 * z),
                    // Nothing but rounding errors is left.
                    _ => {
                        let again = numbers.0.times(&x).minus(&x.times(&numbers.0));
                        let exact = numbers.1.times(&y).minus(&y.times(&numbers.1));
                        assert_eq!(exact.is_positive(), Some(false));
                        assert_eq!(again.is_positive(), None);
                        numbers
                    }
                };
                let (bounded, dyadic, truth) = &numbers;
                assert_eq!(value(dyadic), *truth);
                if bounded.value.is_finite() && bounded.error.is_finite() {
                    assert!(
                        (rational(bounded.value) - truth).abs() <= rational(bounded.error),
                        "{bounded:?}"
                    );
                }
                assert_eq!(dyadic.is_positive(), Some(truth.is_positive()));
                match bounded.is_positive() {
                    Some(sign) => assert_eq!(sign, truth.is_positive()),
                    None => open += 1,
                }
                decided += usize::from(bounded.is_positive().is_some());
            }
        }
        assert!(decided > 10_000 && open > 5, "{decided} {open}");
    }

    #[test]
    fn quotients_by_roots_are_rounded_down() {
        for (n, square, exact) in
            [(3.0, 4.0, 1.5), (5.0, 2.0, 12.5_f64.sqrt()), (-1.0, 4.0, 0.0), (1.0, 0.0, 0.0)]
        {
            let bounded = Bounded::from_f64(n).over_root(&Bounded::from_f64(square));
            let dyadic = Dyadic::from_f64(n).over_root(&Dyadic::from_f64(square));
            for [lower, upper] in [bounded, dyadic] {
                assert!(lower <= exact && lower >= exact * (1.0 - 1e-14), "{n} / sqrt({square}): {lower}");
                let open = square == 0.0 && upper == f64::INFINITY;
                assert!(
                    open || upper >= exact && upper <= exact * (1.0 + 1e-14),
                    "{n} / sqrt({square}): {upper}"
                );
            }
        }
        // Where squares of doubles underflow.
        let small = Dyadic::from_f64(1e-290);
        let [found, _] = small.times(&small).over_root(&small.times(&small));
        assert!((found / 1e-290 - 1.0).abs() < 1e-14, "{found:e}");
    }
}
