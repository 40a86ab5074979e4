//! The separating-direction bound for two triangles.
//!
//! For a fixed direction n with `n.d_ab > 0` for all nine pairs of corners (a of X, b of Y):
//!
//! ```text
//! R(X, Y) >= min over (a, b) of  n.d_ab / |B_ab' n|,    d_ab = p_b - p_a,  B_ab = A_b - A_a
//! ```
//!
//! Call the right side t. For `|z| < t` each computed corner of Y lies beyond each computed corner of X along n, so n
//! separates the two triangles. It holds for any n, any rank, any modes; rounding is covered by
//! `(n.d_ab - e0) / (|B_ab' n| + e1)` with the error terms of [`GapError`](crate::model::GapError).

use glam::DVec3;

use crate::model::rows::{project, squared_distance};
use crate::model::{GapError, norm_up, radius};

/// Two triangles at rest and the scaled modes of their six corners.
#[derive(Clone, Copy)]
pub(crate) struct TrianglePair<'a> {
    pub(crate) x: [DVec3; 3],
    pub(crate) y: [DVec3; 3],
    pub(crate) modes_x: [&'a [f64]; 3],
    pub(crate) modes_y: [&'a [f64]; 3],
}

impl TrianglePair<'_> {
    /// The nine differences `p_b - p_a`, at index `3 a + b`.
    pub(crate) fn differences(&self) -> [DVec3; 9] {
        std::array::from_fn(|i| self.y[i % 3] - self.x[i / 3])
    }
}

/// The bound for one direction n (as made by [`direction`](crate::model::direction)). `projections` is
/// scratch of six rows.
pub(crate) fn direction_bound(
    pair: &TrianglePair<'_>,
    differences: &[DVec3; 9],
    n: DVec3,
    error: &GapError,
    projections: &mut [f64],
) -> f64 {
    let smallest = differences.iter().map(|d| n.dot(*d)).fold(f64::INFINITY, f64::min);
    let rest_error = error.rest(n);
    if smallest.is_nan() || smallest <= rest_error {
        return 0.0;
    }
    let row = projections.len() / 6;
    for (i, modes) in pair.modes_x.iter().chain(&pair.modes_y).enumerate() {
        project(modes, n, &mut projections[i * row..][..row]);
    }
    let errors = (rest_error, error.rate(n));
    let mut bound = f64::INFINITY;
    for (i, d) in differences.iter().enumerate() {
        let [a, b] = [i / 3, 3 + i % 3].map(|i| &projections[i * row..][..row]);
        bound = bound.min(point_bound(n.dot(*d), a, b, errors));
    }
    bound
}

/// The bound for two points along a direction: their gap, their projected modes, and the direction's
/// [`GapError::rest`] and [`GapError::rate`].
#[inline]
pub(crate) fn point_bound(gap: f64, a: &[f64], b: &[f64], (rest_error, rate_error): (f64, f64)) -> f64 {
    let gap = gap - right_or!(rest_error, DirectionWithoutRestError, 0.0);
    let rate = norm_up(squared_distance(a, b), a.len());
    radius(gap, rate + right_or!(rate_error, DirectionWithoutRateError, 0.0))
}

/// A lower bound of the rest distance of the two triangles: the smallest gap along n over its length.
pub(crate) fn rest_distance(differences: &[DVec3; 9], n: DVec3, error: &GapError) -> f64 {
    let gap = differences.iter().map(|d| n.dot(*d)).fold(f64::INFINITY, f64::min);
    radius(gap - error.rest(n), n.length() * crate::model::UP)
}
