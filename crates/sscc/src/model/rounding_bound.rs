//! The rounding bound of a gap: an upper bound of the amount by which the computed gap of two points of the shape along a
//! direction may be smaller than the gap in exact arithmetic.
//!
//! For a direction dir and the exact gap `dir.(d + B z)` the bound is `at_rest(dir) + per_norm(dir) |z|`. It covers two
//! errors:
//!
//! - Positions are computed with r products and r sums, each rounded once. Their error is at most
//!   `gamma_(r+1) sum_c |dir_c| ((|p_a| + |p_b|)_c + sum_k (|A_a| + |A_b|)_ck |z_k|)`, plus underflow. About a centre
//!   c, p is `|p| + |U||c|`, and the positions there are rounded once more in the same way. In a dense metric A is
//!   `|A||S||S^-1|`, which also covers the rounding of A itself.
//! - The bounds of section 5 evaluate `dir.d`, `B'dir`, scaled modes, midpoints and box corners with a few more
//!   roundings of the same magnitudes.
//!
//! One gamma large enough for both serves all points of the model; by Cauchy-Schwarz over k, the sum over modes is at most
//! `|z|` times the 2-norm of a row of A.

use glam::DVec3;

use super::rounding::ROUND_UP;

/// A rounding bound for all points of a model, along any direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RoundingBound {
    /// The part for each axis that does not depend on z.
    at_rest: DVec3,
    /// The part for each axis per unit of `|z|`.
    per_norm: DVec3,
}

/// A gap along one direction, `at_rest + per_norm |z|`: a larger gap in exact arithmetic proves two points separate.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeastGap {
    pub(crate) at_rest: f64,
    pub(crate) per_norm: f64,
}

impl LeastGap {
    /// Returns the sum of two gaps.
    #[inline]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { at_rest: self.at_rest + other.at_rest, per_norm: self.per_norm + other.per_norm }
    }
}

/// Roundings that the bound allows in addition to the r roundings of positions: those of scaling, differences, midpoints, dot
/// products and norms in the bounds. The longest chain that was counted, of the gap of two nodes, has 11.
const EXTRA_ROUNDINGS: usize = 96;

impl RoundingBound {
    /// Computes the bound from the largest magnitudes, for each axis, of positions and of rows of scaled modes.
    pub(crate) fn new(rest_reach: DVec3, mode_reach: DVec3, rank: usize) -> Self {
        let n = (2 * rank + EXTRA_ROUNDINGS) as f64 * (f64::EPSILON / 2.0);
        let gamma = n / (1.0 - n);
        let underflow = (rank + EXTRA_ROUNDINGS) as f64 * 4.0 * f64::from_bits(1);
        Self {
            at_rest: rest_reach * (2.0 * gamma) + DVec3::splat(underflow),
            per_norm: mode_reach * (2.0 * gamma),
        }
    }

    /// Returns the rounding bound of gaps that are measured at one z and used at another, both of at most this norm. The gap
    /// is rounded at both; another factor of two covers the evaluation.
    ///
    /// (A factor of 1 would do. Two positions are rounded by `2 (r + 1)` units of 2^-53 of the reach, at both z by
    /// `4 r + 4`. The bound has `4 r + 2 EXTRA_ROUNDINGS`, and evaluation needs less than a third of the latter.)
    pub(crate) fn between_configurations(&self, norm: f64) -> Self {
        let moved = with_mutant!(self.per_norm * norm, SafeDistanceErrorAtRest, DVec3::ZERO);
        let times = with_mutant!(4.0 * ROUND_UP, GapRoundedOnce, ROUND_UP);
        Self { at_rest: (self.at_rest + moved) * times, per_norm: self.per_norm }
    }

    /// Returns the part of the bound that does not depend on z, along a direction, rounded up.
    pub(crate) fn at_rest(&self, dir: DVec3) -> f64 {
        dir.abs().dot(self.at_rest) * ROUND_UP + f64::MIN_POSITIVE
    }

    /// Returns the part of the bound per unit of `|z|`, along a direction, rounded up; 0 only if all modes are 0.
    pub(crate) fn per_norm(&self, dir: DVec3) -> f64 {
        dir.abs().dot(self.per_norm) * ROUND_UP
    }

    /// Returns both parts along a direction.
    #[inline]
    pub(crate) fn along(&self, dir: DVec3) -> LeastGap {
        LeastGap { at_rest: self.at_rest(dir), per_norm: self.per_norm(dir) }
    }
}

/// Scales a direction so that its largest component is 1; `None` if it is 0 or not finite. Rounding bounds assume such
/// directions: products with them do not underflow.
pub(crate) fn scale_direction(dir: DVec3) -> Option<DVec3> {
    let dir = dir / dir.abs().max_element();
    dir.is_finite().then_some(dir)
}
