//! Points that move with z', and the inequality that keeps them apart below a radius.
//!
//! A coordinate of a point is a row of 1 + r numbers: its value at the centre, then its rate along each component of z'. A point has
//! three rows, one after the other.

use crate::dyadic::{Dyadic, Vector};

/// A radius for `|z'|`; `None` is infinite.
pub(crate) type Radius = Option<Dyadic>;

/// The three rows of a point, or of the difference of two points.
pub(crate) type Point = [Dyadic];

/// A triangle, or a quarter of one.
pub(crate) type Triangle<'a> = [&'a Point; 3];

/// Returns a row of a point.
fn row(point: &Point, component: usize) -> &[Dyadic] {
    let length = point.len() / 3;
    &point[component * length..][..length]
}

/// Returns a point at the centre.
pub(crate) fn position(point: &Point) -> Vector {
    std::array::from_fn(|c| row(point, c)[0].clone())
}

/// Returns the row of a point along a direction.
pub(crate) fn along(point: &Point, dir: &Vector) -> Vec<Dyadic> {
    let length = point.len() / 3;
    (0..length).map(|k| (0..3).map(|c| &dir[c] * &point[c * length + k]).sum()).collect()
}

/// Returns `a + b`, of points or rows.
pub(crate) fn sum(a: &[Dyadic], b: &[Dyadic]) -> Vec<Dyadic> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

/// Returns `a - b`, of points or rows.
pub(crate) fn difference(a: &[Dyadic], b: &[Dyadic]) -> Vec<Dyadic> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Returns the middles of the three edges of a triangle.
pub(crate) fn middles([p, q, r]: Triangle<'_>) -> [Vec<Dyadic>; 3] {
    [[p, q], [q, r], [r, p]].map(|[a, b]| sum(a, b).iter().map(|x| x.times_power(-1)).collect())
}

/// Returns the four quarters of a triangle, which share its corners and its middles.
pub(crate) fn quarters<'a>([p, q, r]: Triangle<'a>, [pq, qr, rp]: &'a [Vec<Dyadic>; 3]) -> [Triangle<'a>; 4] {
    [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]]
}

/// Returns the nine differences of corners, from the first triangle to the second.
pub(crate) fn differences(x: Triangle<'_>, y: Triangle<'_>) -> Vec<Vec<Dyadic>> {
    x.iter().flat_map(|i| y.iter().map(move |j| difference(j, i))).collect()
}

/// Returns the squared length of what an affine map leaves of a component's rates. `gradient`: the rates of
/// this component along each axis.
pub(crate) fn squared_residual(point: &Point, component: usize, gradient: [&[Dyadic]; 3]) -> Dyadic {
    let offset = position(point);
    let map = |k: usize| (0..3).map(|j| &offset[j] * &gradient[j][k]).sum();
    row(point, component)[1..].iter().enumerate().map(|(k, a)| (a - &map(k)).square()).sum()
}

/// Whether `gap - (rate + root(square)) |z'|` is positive for all z' below a radius: it must be positive at `z' = 0` and not
/// negative at the radius, where the root is compared by squares. Below an infinite radius, rate and square must be 0.
pub(crate) fn stays_open(gap: &Dyadic, rate: &Dyadic, square: &Dyadic, radius: &Radius) -> bool {
    let Some(radius) = radius else {
        return gap.is_positive() && rate.is_zero() && square.is_zero();
    };
    let left = gap - &(radius * rate);
    gap.is_positive() && left >= Dyadic::default() && left.square() >= &radius.square() * square
}

/// Whether two points are apart along a direction below a radius. `x`, `y`: their rows along it; `errors`: e0 and e1 such that their gap may
/// be smaller by `e0 + e1 |z'|`.
pub(crate) fn are_apart(x: &[Dyadic], y: &[Dyadic], errors: &[Dyadic; 2], radius: &Radius) -> bool {
    let gap = &(&y[0] - &x[0]) - &errors[0];
    let square = x[1..].iter().zip(&y[1..]).map(|(a, b)| (a - b).square()).sum();
    stays_open(&gap, &errors[1], &square, radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_close_at_the_radius_and_not_before() {
        let of = Dyadic::of;
        let is_open = |gap: f64, rate: f64, square: f64, radius: f64| {
            stays_open(&of(gap), &of(rate), &of(square), &Some(of(radius)))
        };
        // The gap 10 - (2 + 3) |z| is 0 at 2.
        assert!(is_open(10.0, 2.0, 9.0, 2.0));
        assert!(!is_open(10.0, 2.0, 9.0, 2.0_f64.next_up()) && !is_open(10.0, 2.0, 9.0_f64.next_up(), 2.0));
        assert!(!is_open(10.0_f64.next_down(), 2.0, 9.0, 2.0) && !is_open(0.0, 0.0, 0.0, 1.0));
        // A negative left side must fail, although its square is large enough.
        assert!(!is_open(1.0, 100.0, 1.0, 1.0));
        let infinite = |rate: f64, square: f64| stays_open(&of(1.0), &of(rate), &of(square), &None);
        assert!(infinite(0.0, 0.0) && !infinite(5e-324, 0.0) && !infinite(0.0, 5e-324));
    }
}
