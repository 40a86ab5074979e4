//! Directed rounding: upper bounds of norms, lower bounds of quotients and radii.
//!
//! IEEE 754 arithmetic rounds to nearest; a factor a few units in the last place from 1 turns the result into a bound.

/// Rounds up a sum or product of a handful of non-negative numbers.
pub(crate) const ROUND_UP: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Rounds down a quotient of two numbers.
pub(crate) const ROUND_DOWN: f64 = 1.0 - 8.0 * f64::EPSILON;

/// The root of a sum of squares of at most `terms` numbers, rounded up.
#[inline]
pub(crate) fn norm_up(sum_of_squares: f64, terms: usize) -> f64 {
    sum_of_squares.sqrt() * right_or!(1.0 + (terms as f64 + 16.0) * f64::EPSILON, NormUpToNearest, 1.0)
}

/// A quotient of two non-negative numbers, rounded down. Below the normal numbers, where rounding is not relative, it is
/// 0.
#[inline]
pub(crate) fn quotient_down(numerator: f64, denominator: f64) -> f64 {
    let quotient = numerator / denominator;
    if quotient < f64::MIN_POSITIVE { 0.0 } else { quotient * right_or!(ROUND_DOWN, QuotientToNearest, 1.0) }
}

/// The radius at which a gap closes at a rate, rounded down: 0 unless the gap is positive (NaN included), infinite where
/// the rate is 0.
#[inline]
pub(crate) fn radius_down(gap: f64, rate: f64) -> f64 {
    if gap > 0.0 && rate >= 0.0 { quotient_down(gap, rate) } else { 0.0 }
}

/// A radius in single precision, rounded down.
pub(crate) fn to_f32_down(radius: f64) -> f32 {
    let rounded = radius as f32;
    let is_above = right_or!(f64::from(rounded) > radius, RadiusToNearest, false);
    let rounded = if is_above { rounded.next_down() } else { rounded };
    rounded.clamp(0.0, f32::MAX)
}
