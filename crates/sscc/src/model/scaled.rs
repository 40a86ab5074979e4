//! The model in scaled coordinates, `A = U S^-1`, and the error terms of its computed positions.

use glam::DVec3;

use super::rows::padded;
use crate::{Metric, ReducedModel};

/// Bounds, for two points of the shape and a direction n, by how much the computed gap along n may
/// fall short of `n.(d + B z)` in exact arithmetic: at most `rest(n) + rate(n) |z|`.
///
/// Two things add up. The positions are computed with r products and r sums, each rounded once: at most
/// `gamma_(r+1) sum_c |n_c| ((|p_x| + |p_y|)_c + sum_k (|A_x| + |A_y|)_ck |z_k|)`, plus underflow; about a centre c,
/// p is `|p| + |U||c|`, and the positions there are rounded once more in the same way; for a dense metric A is
/// `|A||S||S^-1|`, which also covers what solving for A rounds. And the bounds
/// evaluate `n.d`, `B'n`, scaled modes, midpoints and box corners with a few more roundings of the same
/// magnitudes. One gamma with room for both is used for all points of the model:
/// Cauchy-Schwarz over k turns the sum into `|z|` times the 2-norm of a row of A.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GapError {
    rest: DVec3,
    rate: DVec3,
}

/// Roundings granted beside the r of the positions: those of scaling, differences, midpoints, dot products
/// and norms in the bounds, none of which chains more than a third of this many.
const EXTRA_ROUNDINGS: usize = 96;

impl GapError {
    pub(crate) fn new(rest_reach: DVec3, rate_reach: DVec3, rank: usize) -> Self {
        let n = (2 * rank + EXTRA_ROUNDINGS) as f64 * (f64::EPSILON / 2.0);
        let gamma = n / (1.0 - n);
        let underflow = (rank + EXTRA_ROUNDINGS) as f64 * 4.0 * f64::from_bits(1);
        Self { rest: rest_reach * (2.0 * gamma) + DVec3::splat(underflow), rate: rate_reach * (2.0 * gamma) }
    }

    /// The error between two z, both of at most that norm, in the place of one between rest and z: the gap is rounded
    /// at both. Again twice that, for what evaluating the bounds about z rounds.
    pub(crate) fn within(&self, norm: f64) -> Self {
        let moved = right_or!(self.rate * norm, MarginErrorAtRest, DVec3::ZERO);
        Self { rest: (self.rest + moved) * (4.0 * UP), rate: self.rate }
    }

    /// The part of the error that does not depend on z, for a direction n, rounded up.
    pub(crate) fn rest(&self, n: DVec3) -> f64 {
        n.abs().dot(self.rest) * UP + f64::MIN_POSITIVE
    }

    /// The part of the error per unit of `|z|`, for a direction n, rounded up; 0 only when no mode moves
    /// anything.
    pub(crate) fn rate(&self, n: DVec3) -> f64 {
        n.abs().dot(self.rate) * UP
    }
}

/// Covers a handful of roundings of a sum or product of non-negative numbers.
pub(crate) const UP: f64 = 1.0 + 16.0 * f64::EPSILON;

/// Rounds a quotient of certified parts down.
pub(crate) const DOWN: f64 = 1.0 - 8.0 * f64::EPSILON;

/// A direction scaled so that its largest component is 1 (none when it is 0 or not finite). Every direction
/// passes through here before it is evaluated: the error terms assume that its products do not underflow.
pub(crate) fn direction(n: DVec3) -> Option<DVec3> {
    let n = n / n.abs().max_element();
    n.is_finite().then_some(n)
}

/// A quotient `numerator / denominator` as a radius: 0 unless the numerator is positive (NaN included),
/// infinite where nothing moves.
#[inline]
pub(crate) fn radius(numerator: f64, denominator: f64) -> f64 {
    if numerator > 0.0 && denominator >= 0.0 { quotient_down(numerator, denominator) } else { 0.0 }
}

/// A quotient of two numbers that are not negative, rounded down. Below the normal numbers, where rounding is no
/// longer relative, it is 0.
#[inline]
pub(crate) fn quotient_down(numerator: f64, denominator: f64) -> f64 {
    let quotient = numerator / denominator;
    if quotient < f64::MIN_POSITIVE { 0.0 } else { quotient * right_or!(DOWN, QuotientToNearest, 1.0) }
}

/// The root of a sum of squares over at most `terms` numbers, rounded up.
#[inline]
pub(crate) fn norm_up(sum_of_squares: f64, terms: usize) -> f64 {
    sum_of_squares.sqrt() * right_or!(1.0 + (terms as f64 + 16.0) * f64::EPSILON, NormUpToNearest, 1.0)
}

/// Positions at the centre (called rest below) and scaled modes of a model, laid out for the bounds.
pub(crate) struct ScaledModel {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) faces: Vec<[u32; 3]>,
    /// Modes in one row: the rank, padded to whole lanes.
    pub(crate) row: usize,
    /// For each vertex three rows (x, y, z).
    modes: Vec<f64>,
    pub(crate) error: GapError,
}

impl ScaledModel {
    /// About the configuration `center`, from which z and radii are measured.
    pub(crate) fn new(model: &ReducedModel, metric: &Metric, center: &[f64]) -> Self {
        let mesh = model.mesh();
        let rank = model.rank();
        let positions: Vec<DVec3> =
            (0..mesh.rest_positions().len() as u32).map(|v| model.position(v, center)).collect();
        let row = padded(rank);
        let mut modes = vec![0.0; positions.len() * 3 * row];
        let mut rest_reach = DVec3::ZERO;
        let mut rate_reach = DVec3::ZERO;
        let (mut scaled, mut magnitudes) = (vec![DVec3::ZERO; rank], vec![DVec3::ZERO; rank]);
        for v in mesh.used_vertices() {
            let rows = &mut modes[v as usize * 3 * row..][..3 * row];
            let of_vertex = model.modes().of_vertex(v);
            metric.scaled_modes(of_vertex, &mut scaled);
            for (k, a) in scaled.iter().enumerate() {
                [rows[k], rows[row + k], rows[2 * row + k]] = a.to_array();
            }
            // What is added up on the way to the centre is rounded, too.
            let moved: DVec3 = of_vertex.iter().zip(center).map(|(u, q)| (*u * *q).abs()).sum();
            let at_rest = mesh.rest_positions()[v as usize].abs();
            rest_reach = rest_reach.max(at_rest + right_or!(moved, RestErrorWithoutCentre, DVec3::ZERO));
            metric.magnitudes(&scaled, &mut magnitudes);
            let norm = |c: usize| norm_up(magnitudes.iter().map(|m| m[c] * m[c]).sum(), row);
            rate_reach = rate_reach.max(DVec3::new(norm(0), norm(1), norm(2)));
        }
        // A component that never moves beside others that do still needs an error above what squares
        // lose to underflow (checked modes are largest above 2^-200, squares vanish below 2^-537).
        let floor = rate_reach.max_element() * f64::EPSILON;
        let rate_reach = rate_reach.max(DVec3::splat(floor));
        let error = GapError::new(rest_reach, rate_reach, model.rank());
        Self { positions, faces: mesh.faces().to_vec(), row, modes, error }
    }

    /// The modes of a vertex: three rows.
    #[inline]
    pub(crate) fn modes(&self, vertex: u32) -> &[f64] {
        let width = 3 * self.row;
        &self.modes[vertex as usize * width..][..width]
    }
}
