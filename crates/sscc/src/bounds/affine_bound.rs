//! The affine-residual bound of a triangle pair: for triangles that are close and move almost as one, such as triangles
//! two rings apart on a surface. There the best separating direction changes with q, so a fixed one gives a weak bound.
//!
//! Take any affine map of the modes, `A_i = A_0 + G (p_i - p_0) + E_i` with residuals E. For two points at
//! rest distance `|d| >= delta` and `u = d / |d|`: `|B'u| <= |d| g + e`, with `g >= max over unit u of |G(u)'u|` and
//! `e >= |E_j - E_i|_2` over all pairs of corners. Hence
//!
//! ```text
//! R_ab >= (delta - e0) / (g delta + e + e1)
//! ```
//!
//! B holds the relative modes of the two points; e0 and e1 are the two parts of the [`RoundingBound`]. The bound grows with
//! delta, so a lower bound of the distance suffices. Only the symmetric part of each mode's gradient enters g: a local
//! infinitesimal rotation costs nothing. One map may serve many triangle pairs.
//!
//! A clearance (`required_gap.rs`) needs a gap along the unit direction u of more than D in place of 0, with the rate D' at which D grows:
//! `(delta - e0 - D) / (g delta + e + e1 + D')`. For `D + e0 >= 0` this grows with delta, too: its derivative has the sign of
//! `e + e1 + D' + g (e0 + D)`. The proof holds for each two points of the triangles with a direction u of their own: all points
//! stay farther apart than D.

use glam::DVec3;

use super::affine_fit::AffineFit;
use super::cone_rate::{PYRAMID_MARGIN, bound_rate_in_cone, enclose_in_pyramid};
use super::pair_corners::PairCorners;
use super::strain::{StrainGram, bound_rate, strain_gram};
use crate::model::ScaledModel;
use crate::model::rounding::{ROUND_UP, larger_or_nan, radius_down};

/// An affine map of some points' modes, and a bound of the rate at which it moves points apart. Owns its memory.
pub(super) struct AffineBound {
    row_len: usize,
    fit: AffineFit,
    gram: StrainGram,
    /// An upper bound of `|G(u)'u|` over all unit vectors u.
    rate: f64,
}

/// The input of the bound of one triangle pair.
#[derive(Clone, Copy)]
pub(super) struct AffinePair<'a> {
    /// The differences of the corners.
    pub(super) differences: &'a [DVec3; 9],
    /// A lower bound of the rest distance.
    pub(super) rest_distance: f64,
    /// The largest [`AffineBound::squared_residual`] between a corner of a and one of b.
    pub(super) squared_residual: f64,
}

/// The terms of the bound beside the rate.
struct AffineTerms {
    /// A lower bound of the rest distance.
    delta: f64,
    at_rest: f64,
    slack: f64,
    rate_rounding: f64,
}

impl AffineTerms {
    fn bound(&self, rate: f64) -> f64 {
        let Self { delta, at_rest, slack, rate_rounding } = *self;
        radius_down(delta - at_rest, ((rate * ROUND_UP + rate_rounding) * delta + slack) * ROUND_UP)
    }

    /// Returns a rate with a sufficient bound, slightly smaller than the largest such rate. None if there is none.
    fn slower_than(&self, sufficient: f64) -> Option<f64> {
        let Self { delta, at_rest, slack, rate_rounding } = *self;
        let wanted = ((delta - at_rest) / sufficient - slack) / delta - rate_rounding;
        (wanted > 0.0).then_some(wanted * (1.0 - 1e-9))
    }
}

impl AffineBound {
    pub(super) fn new(row_len: usize) -> Self {
        Self { row_len, fit: AffineFit::new(row_len), gram: [[0.0; 6]; 6], rate: 0.0 }
    }

    /// Fits points with these offsets from the first of them, and these modes. Returns false if all points coincide, or
    /// a weight is not finite.
    pub(super) fn fit<'m>(&mut self, offsets: &[DVec3], modes: impl Fn(usize) -> &'m [f64]) -> bool {
        let is_fitted = self.fit.fit(offsets, modes);
        if is_fitted {
            self.gram = strain_gram(self.fit.gradient(), self.row_len);
            self.rate = bound_rate(&self.gram, self.row_len);
        }
        is_fitted
    }

    /// Returns the squared difference of the residuals of two points, rounded to nearest.
    pub(super) fn squared_residual(&self, i: usize, j: usize) -> f64 {
        self.fit.squared_residual(i, j)
    }

    /// Returns the bound of two triangles among the points.
    pub(super) fn bound(&self, pair: AffinePair<'_>, sufficient: f64, model: &ScaledModel) -> f64 {
        let terms = self.terms(&pair, model);
        let over_all_directions = terms.bound(self.rate);
        if over_all_directions >= sufficient {
            return over_all_directions;
        }
        match terms.slower_than(sufficient) {
            Some(wanted) => {
                let rate =
                    bound_rate_in_cone(pair.differences, &self.gram, self.row_len, wanted, PYRAMID_MARGIN);
                over_all_directions.max(terms.bound(rate))
            }
            None => over_all_directions,
        }
    }

    /// Returns the rate over a pyramid of directions that proves two triangles apart below a radius, and the pyramid. None if
    /// that fails.
    pub(super) fn witness(
        &self,
        pair: AffinePair<'_>,
        radius: f64,
        model: &ScaledModel,
    ) -> Option<(f64, [DVec3; 4])> {
        let terms = self.terms(&pair, model);
        let wanted = terms.slower_than(radius)?;
        // Corners of sub-triangles are rounded; the pyramid of a witness must contain the exact ones.
        let margin = PYRAMID_MARGIN + 8.0 * model.rounding.at_rest(DVec3::ONE) / pair.rest_distance;
        let rate = bound_rate_in_cone(pair.differences, &self.gram, self.row_len, wanted, margin);
        let is_proven = terms.bound(rate) >= radius;
        enclose_in_pyramid(pair.differences, margin)
            .filter(|_| is_proven)
            .map(|pyramid| (rate * ROUND_UP + terms.rate_rounding, pyramid))
    }

    fn terms(&self, pair: &AffinePair<'_>, model: &ScaledModel) -> AffineTerms {
        let rounding = &model.rounding;
        let residual = self.fit.residual_up(pair.squared_residual, rounding);
        let axes = DVec3::ONE; // |u_c| <= 1 for each component of a unit direction
        let required = with_mutant!(model.required.along_unit(), AffineWithoutClearance, Default::default());
        let per_norm =
            with_mutant!(2.0 * rounding.per_norm(axes), AffineWithoutRateError, 0.0) + required.per_norm;
        AffineTerms {
            delta: pair.rest_distance,
            at_rest: rounding.at_rest(axes) + required.at_rest,
            slack: (residual + per_norm) * ROUND_UP,
            rate_rounding: 8.0 * f64::EPSILON * self.fit.frobenius(),
        }
    }

    /// Returns the gradient of the map: nine rows, `G_cj` at `3 c + j`.
    pub(super) fn gradient(&self) -> &[f64] {
        self.fit.gradient()
    }

    /// Returns the bound of two triangles by an affine map of their own six corners.
    pub(super) fn fit_and_bound(
        &mut self,
        pair: &PairCorners<'_>,
        differences: &[DVec3; 9],
        rest_distance: f64,
        sufficient: f64,
        model: &ScaledModel,
    ) -> f64 {
        let [a0, a1, a2] = pair.corners.a;
        let [b0, b1, b2] = pair.corners.b;
        let offsets = [a0, a1, a2, b0, b1, b2].map(|p| p - a0);
        let [a0, a1, a2] = pair.modes_a;
        let [b0, b1, b2] = pair.modes_b;
        let modes = [a0, a1, a2, b0, b1, b2];
        if !self.fit(&offsets, |i| modes[i]) {
            return 0.0;
        }
        let mut squared_residual = 0.0_f64;
        for i in 0..3 {
            for j in 3..6 {
                squared_residual = larger_or_nan(squared_residual, self.squared_residual(i, j));
            }
        }
        self.bound(AffinePair { differences, rest_distance, squared_residual }, sufficient, model)
    }
}

/// Whether two triangles are so close that the affine bound is usually larger than that along a fixed direction: their
/// distance is less than half the distance of their farthest corners.
pub(super) fn is_near(differences: &[DVec3; 9], rest_distance: f64) -> bool {
    let farthest = differences.iter().map(|d| d.length_squared()).fold(0.0, f64::max);
    farthest > 4.0 * rest_distance * rest_distance
}

#[cfg(test)]
mod tests;
