//! Directed rounding: upper bounds of norms, lower bounds of quotients and radii.
//!
//! IEEE 754 arithmetic rounds to nearest; multiplied by a factor a few units in the last place from 1, the result is a bound.

/// Rounds up a sum or product of a handful of non-negative numbers.
pub(crate) const ROUND_UP: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Rounds down a quotient of two numbers.
pub(crate) const ROUND_DOWN: f64 = 1.0 - 8.0 * f64::EPSILON;

/// Returns the root of a sum of squares of at most `terms` numbers, rounded up.
#[inline]
pub(crate) fn norm_up(sum_of_squares: f64, terms: usize) -> f64 {
    sum_of_squares.sqrt() * with_mutant!(1.0 + (terms as f64 + 16.0) * f64::EPSILON, NormUpToNearest, 1.0)
}

/// Returns a quotient of two non-negative numbers, rounded down; 0 in place of NaN and of subnormal numbers, whose rounding is
/// not relative.
#[inline]
pub(crate) fn quotient_down(numerator: f64, denominator: f64) -> f64 {
    let quotient = numerator / denominator;
    let is_normal =
        with_mutant!(quotient >= f64::MIN_POSITIVE, QuotientOfNan, !(quotient < f64::MIN_POSITIVE));
    if is_normal { quotient * with_mutant!(ROUND_DOWN, QuotientToNearest, 1.0) } else { 0.0 }
}

/// Returns the radius at which a gap closes at a rate, rounded down. It is 0 unless the gap is positive (also for NaN), and
/// infinite if the rate is 0.
#[inline]
pub(crate) fn radius_down(gap: f64, rate: f64) -> f64 {
    if gap > 0.0 && rate >= 0.0 { quotient_down(gap, rate) } else { 0.0 }
}

/// Returns the larger one of two numbers; NaN if one of them is NaN, which `max` ignores.
#[inline(always)]
pub(crate) fn larger_or_nan<T: PartialOrd>(a: T, b: T) -> T {
    let is_nan = with_mutant!(b.partial_cmp(&b).is_none(), MaximumIgnoresNan, false);
    if a < b || is_nan { b } else { a }
}

/// Converts a radius to single precision, rounded down; 0 for NaN, and the largest finite number for infinity.
pub(crate) fn to_f32_down(radius: f64) -> f32 {
    let rounded = radius as f32;
    let is_above = with_mutant!(f64::from(rounded) > radius, RadiusToNearest, false);
    let rounded = if is_above { rounded.next_down() } else { rounded };
    if rounded > 0.0 { rounded.min(f32::MAX) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_and_radii_of_nan_are_0() {
        for (a, b) in [(0.0, f64::INFINITY), (f64::INFINITY, 0.0)] {
            // One of these quotients contains the product of infinity and zero.
            assert_eq!(quotient_down(a * b, 1.0), 0.0);
        }
        assert_eq!(quotient_down(f64::INFINITY, f64::INFINITY), 0.0);
        assert_eq!(radius_down(f64::INFINITY, f64::INFINITY), 0.0);
        assert_eq!(radius_down(f64::NAN, 1.0), 0.0);
        assert_eq!(radius_down(1.0, f64::NAN), 0.0);
        assert_eq!(radius_down(1.0, 0.0), f64::INFINITY);
        assert_eq!(to_f32_down(f64::NAN), 0.0);
        assert_eq!(to_f32_down(f64::INFINITY), f32::MAX);
    }

    #[test]
    fn the_larger_one_of_nan_and_a_number_is_nan() {
        assert_eq!((larger_or_nan(1.0, 2.0), larger_or_nan(2.0, 1.0)), (2.0, 2.0));
        assert!(larger_or_nan(f64::NAN, 1.0).is_nan() && larger_or_nan(1.0, f64::NAN).is_nan());
        let numbers = [1.0, f32::NAN, 3.0, 2.0];
        assert!(numbers.into_iter().fold(0.0, larger_or_nan).is_nan());
    }
}
