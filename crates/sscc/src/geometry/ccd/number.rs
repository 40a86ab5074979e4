//! The arithmetic of polynomial predicates: one code, evaluated with two kinds of numbers.
//!
//! A predicate is evaluated with [`BoundedFloat`](super::bounded_float::BoundedFloat) numbers first. Where their error
//! bound does not decide its sign, it is evaluated again with exact [`Dyadic`](super::dyadic::Dyadic) numbers. This is
//! the filter of exact predicates (Shewchuk 1997), with an error bound computed beside the value instead of proven for
//! one expression.

use glam::DVec3;

/// The arithmetic of polynomial predicates.
pub(super) trait Number: Clone {
    /// Returns zero.
    fn zero() -> Self;

    /// Returns the number equal to a double.
    fn from_f64(x: f64) -> Self;

    /// Returns the difference of two doubles.
    fn difference(a: f64, b: f64) -> Self;

    /// Returns the sum.
    fn plus(&self, other: &Self) -> Self;

    /// Returns the difference.
    fn minus(&self, other: &Self) -> Self;

    /// Returns the product.
    fn times(&self, other: &Self) -> Self;

    /// Returns the smaller of two numbers.
    fn minimum(&self, other: &Self) -> Self;

    /// Whether the number is above 0. None if the error bound does not decide it.
    fn is_positive(&self) -> Option<bool>;

    /// Returns bounds of `self / sqrt(square)`. They differ by the error bounds of both numbers and a few units in the
    /// last place. The lower bound of a number that is not provably positive is 0. If a rounded square may be 0, the
    /// upper bound is infinity; if an exact square is 0, both bounds are 0.
    fn over_root(&self, square: &Self) -> Bounds;

    /// Returns a vector of the same direction, rounded.
    fn direction(n: &[Self; 3]) -> DVec3;
}

/// A lower and an upper bound of one number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) lower: f64,
    pub(super) upper: f64,
}

/// Returns `2^exponent`; 0 below the normal numbers, and no more than 2^1023.
pub(super) fn power_of_two(exponent: i64) -> f64 {
    match exponent {
        ..-1022 => 0.0,
        _ => f64::from_bits(((1023 + exponent.min(1023)) as u64) << 52),
    }
}
