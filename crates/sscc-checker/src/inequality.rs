//! The inequality of all witnesses: a gap is positive below a radius.

use crate::dyadic::Dyadic;
use crate::scaled::Radius;

/// Whether `gap - (rate + root(square)) |z'|` is positive for all z' below a radius: it must be positive at `z' = 0` and not
/// negative at the radius, where the root is compared by squares. Below an infinite radius, rate and square must be 0.
pub(crate) fn stays_open(gap: &Dyadic, rate: &Dyadic, square: &Dyadic, radius: &Radius) -> bool {
    let Radius::Finite(radius) = radius else {
        return gap.is_positive() && rate.is_zero() && square.is_zero();
    };
    let left = gap - &(radius * rate);
    gap.is_positive() && left >= Dyadic::default() && left.square() >= &radius.square() * square
}

/// Whether two points are apart along a direction below a radius: `x`, `y`: their rows along it; `rest_error`, `rate_error`: their gap is
/// smaller by at most `rest_error + rate_error |z'|`.
pub(crate) fn are_apart(
    x: &[Dyadic],
    y: &[Dyadic],
    [rest_error, rate_error]: &[Dyadic; 2],
    radius: &Radius,
) -> bool {
    let gap = &(&y[0] - &x[0]) - rest_error;
    let square = x[1..].iter().zip(&y[1..]).map(|(a, b)| (a - b).square()).sum();
    stays_open(&gap, rate_error, &square, radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_close_at_the_radius_and_not_before() {
        let of = Dyadic::of;
        let is_open = |gap: f64, rate: f64, square: f64, radius: f64| {
            stays_open(&of(gap), &of(rate), &of(square), &Radius::Finite(of(radius)))
        };
        // The gap 10 - (2 + 3) |z| is 0 at 2.
        assert!(is_open(10.0, 2.0, 9.0, 2.0));
        assert!(!is_open(10.0, 2.0, 9.0, 2.0_f64.next_up()) && !is_open(10.0, 2.0, 9.0_f64.next_up(), 2.0));
        assert!(!is_open(10.0_f64.next_down(), 2.0, 9.0, 2.0) && !is_open(0.0, 0.0, 0.0, 1.0));
        // A negative left side must fail, although its square is large enough.
        assert!(!is_open(1.0, 100.0, 1.0, 1.0));
        let infinite =
            |rate: f64, square: f64| stays_open(&of(1.0), &of(rate), &of(square), &Radius::Infinite);
        assert!(infinite(0.0, 0.0) && !infinite(5e-324, 0.0) && !infinite(0.0, 5e-324));
    }
}
