//! Points that move with z'.
//!
//! A coordinate of a point is a row of 1 + r numbers: its value at the centre, then its rate along each component of z'. A point has
//! three rows, one after the other.

use crate::dyadic::{Dyadic, Vector};

/// The three rows of a point, or of the difference of two points.
pub(crate) type Point = [Dyadic];

/// A triangle, or a quarter of one.
pub(crate) type Triangle<'a> = [&'a Point; 3];

/// Returns a row of a point.
pub(crate) fn row(point: &Point, component: usize) -> &[Dyadic] {
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

fn middle(p: &Point, q: &Point) -> Vec<Dyadic> {
    sum(p, q).iter().map(|x| x.times_power(-1)).collect()
}

/// Returns the middles of the three edges of a triangle.
pub(crate) fn middles([p, q, r]: Triangle<'_>) -> [Vec<Dyadic>; 3] {
    [middle(p, q), middle(q, r), middle(r, p)]
}

/// Returns the four quarters of a triangle, which share its corners and its middles.
pub(crate) fn quarters<'a>([p, q, r]: Triangle<'a>, [pq, qr, rp]: &'a [Vec<Dyadic>; 3]) -> [Triangle<'a>; 4] {
    [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]]
}

/// Returns the nine differences of corners, from the first triangle to the second.
pub(crate) fn differences(x: Triangle<'_>, y: Triangle<'_>) -> Vec<Vec<Dyadic>> {
    x.iter().flat_map(|i| y.iter().map(move |j| difference(j, i))).collect()
}

/// Returns the squared length of what an affine map leaves of the rates of a row. `offset`: the position that the map maps; `gradient`: its
/// rates along each axis.
pub(crate) fn squared_residual(row: &[Dyadic], offset: &Vector, gradient: [&[Dyadic]; 3]) -> Dyadic {
    let map = |k: usize| (0..3).map(|j| &offset[j] * &gradient[j][k]).sum();
    row[1..].iter().enumerate().map(|(k, a)| (a - &map(k)).square()).sum()
}
