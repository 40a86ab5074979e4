//! The affine-residual bound: for parts that are close and move almost as one, such as triangles two
//! rings apart, where the separating direction turns with q and a fixed one is weak.
//!
//! Take any affine map of the modes, `A_v = A_0 + G (p_v - p_0) + E_v` with residuals E_v. For two points at
//! rest distance `|d| >= delta` and `u = d / |d|`: `|B'u| <= |d| g + e`, with `g >= max over unit u of |G(u)'u|` and
//! `e >= |E_b - E_a|_2` over all pairs of corners. Hence
//!
//! ```text
//! R(X, Y) >= (delta - e0) / (g delta + e + e1)
//! ```
//!
//! (it grows with delta, so a lower bound of the distance serves). Only the symmetric part of each mode's
//! gradient enters g: a local infinitesimal rotation costs nothing. One map may serve many pairs.

use glam::{DMat3, DVec3};

use super::cone::cone_rate;
use super::separating_direction::TrianglePair;
use crate::model::rows::{LANES, dot, padded, squared_distance};
use crate::model::{GapError, UP, norm_up, radius};

/// The affine map of some points' modes, what it leaves over, and how fast it moves points apart; owns its memory.
pub(crate) struct AffineFit {
    row: usize,
    /// Nine rows: `G_cj` at `3 c + j`.
    gradient: Vec<f64>,
    /// For each point three rows.
    residuals: Vec<f64>,
    weights: Vec<DVec3>,
    gram: StrainGram,
    /// The largest `|G(u)'u|`.
    rate: f64,
    frobenius: f64,
    /// The largest distance from the first point.
    longest: f64,
}

impl AffineFit {
    pub(crate) fn new(row: usize) -> Self {
        debug_assert_eq!(row, padded(row));
        Self {
            row,
            gradient: vec![0.0; 9 * row],
            residuals: Vec::new(),
            weights: Vec::new(),
            gram: [[0.0; 6]; 6],
            rate: 0.0,
            frobenius: 0.0,
            longest: 0.0,
        }
    }

    /// Fits points with these offsets from the first of them, and these modes. False where all coincide.
    pub(crate) fn fit<'m>(&mut self, offsets: &[DVec3], modes: impl Fn(usize) -> &'m [f64]) -> bool {
        let row = self.row;
        let Some((normal, free)) = fit(offsets, &mut self.weights) else { return false };
        // Gradient: G[c][j] = sum_v weight_v[j] (A_v - A_0)[c], a row over the modes for each of 3 x 3 entries.
        let first = modes(0);
        self.gradient.fill(0.0);
        for (v, weight) in self.weights.iter().enumerate().skip(1) {
            let modes = modes(v);
            for c in 0..3 {
                let a = &modes[c * row..][..row];
                let a0 = &first[c * row..][..row];
                let rows = &mut self.gradient[3 * c * row..][..3 * row];
                let (g0, rest) = rows.split_at_mut(row);
                let (g1, g2) = rest.split_at_mut(row);
                for k in 0..row {
                    let difference = a[k] - a0[k];
                    g0[k] += weight.x * difference;
                    g1[k] += weight.y * difference;
                    g2[k] += weight.z * difference;
                }
            }
        }
        complete_as_rotation(&mut self.gradient, row, normal, free);
        // Residuals: E_v = (A_v - A_0) - G (p_v - p_0); that of the first is 0.
        self.residuals.clear();
        self.residuals.resize(3 * row * offsets.len(), 0.0);
        for (v, offset) in offsets.iter().enumerate().skip(1) {
            let modes = modes(v);
            for c in 0..3 {
                let a = &modes[c * row..][..row];
                let a0 = &first[c * row..][..row];
                let g = &self.gradient[3 * c * row..][..3 * row];
                let e = &mut self.residuals[(3 * v + c) * row..][..row];
                for k in 0..row {
                    let affine = offset.x * g[k] + offset.y * g[row + k] + offset.z * g[2 * row + k];
                    e[k] = (a[k] - a0[k]) - affine;
                }
            }
        }
        self.frobenius = norm_up(dot(&self.gradient, &self.gradient), 9 * row);
        self.longest = offsets.iter().map(|d| d.length()).fold(0.0, f64::max);
        self.gram = strain_gram(&self.gradient, row);
        self.rate = largest_rate(&self.gram, row);
        true
    }

    /// `|E_b - E_a|^2`, not rounded.
    pub(crate) fn residual(&self, a: usize, b: usize) -> f64 {
        let width = 3 * self.row;
        squared_distance(&self.residuals[a * width..][..width], &self.residuals[b * width..][..width])
    }

    /// `|E_b - E_a|` from above, up to the rate error, from a [`Self::residual`].
    ///
    /// Rounding of the residuals is relative to the scaled modes (covered by the rate error, which [`Self::bound`]
    /// grants twice because two corners are involved on each side) and to `|G| |p_v - p_0|`; and corners of
    /// sub-triangles are themselves rounded, which moves both the offsets here and the directions in the bound.
    pub(super) fn residual_up(&self, residual: f64, error: &GapError) -> f64 {
        let moved = 16.0 * f64::EPSILON * self.longest + 4.0 * error.rest(DVec3::ONE);
        norm_up(residual, 3 * self.row) + right_or!(moved * self.frobenius, AffineResidualExact, 0.0)
    }

    /// The bound for two triangles among the points: the differences of their corners, a rest distance that they at
    /// least have, and the largest [`Self::residual`] between corners of theirs.
    pub(crate) fn bound(
        &self,
        differences: &[DVec3; 9],
        delta: f64,
        residual: f64,
        enough: f64,
        error: &GapError,
    ) -> f64 {
        let row = self.row;
        let e = self.residual_up(residual, error);
        let axes = DVec3::ONE; // |u_c| <= 1 for each component of a unit direction
        let rest_error = error.rest(axes);
        let rate_error = right_or!(2.0 * error.rate(axes), AffineWithoutRateError, 0.0);
        let slack = (e + rate_error) * UP;
        let rounding = 8.0 * f64::EPSILON * self.frobenius;
        let bound = |rate: f64| radius(delta - rest_error, ((rate * UP + rounding) * delta + slack) * UP);
        let all = bound(self.rate);
        if all >= enough {
            return all;
        }
        // The rate that would do.
        let wanted = ((delta - rest_error) / enough - slack) / delta - rounding;
        if wanted.is_nan() || wanted <= 0.0 {
            return all;
        }
        all.max(bound(cone_rate(differences, &self.gram, row, wanted * (1.0 - 1e-9))))
    }
}

/// The bound for two triangles whose rest distance is at least `delta`.
pub(crate) fn affine_bound(
    pair: &TrianglePair<'_>,
    differences: &[DVec3; 9],
    delta: f64,
    enough: f64,
    error: &GapError,
    affine: &mut AffineFit,
) -> f64 {
    let corners = [pair.x[0], pair.x[1], pair.x[2], pair.y[0], pair.y[1], pair.y[2]];
    let [x0, x1, x2] = pair.modes_x;
    let [y0, y1, y2] = pair.modes_y;
    let modes = [x0, x1, x2, y0, y1, y2];
    if !affine.fit(&corners.map(|p| p - corners[0]), |v| modes[v]) {
        return 0.0;
    }
    let mut largest = 0.0_f64;
    for a in 0..3 {
        for b in 3..6 {
            largest = largest.max(affine.residual(a, b));
        }
    }
    affine.bound(differences, delta, largest, enough, error)
}

/// A regularised least-squares fit of a gradient to values at points, `G = sum_v value_v weights_v'`. Gives the unit
/// normal of the plane in which the points (nearly) lie, and how much they leave the gradient across it open: 1 in a
/// plane, 0 where they fill space. None where all coincide.
fn fit(offsets: &[DVec3], weights: &mut Vec<DVec3>) -> Option<(DVec3, f64)> {
    let mean = offsets.iter().sum::<DVec3>() / offsets.len() as f64;
    let mut moment = DMat3::ZERO;
    for d in offsets {
        let d = *d - mean;
        moment += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
    // Points that nearly lie in a plane say nothing about the gradient across it; the regularisation
    // keeps that part small instead of fitting noise.
    let ridge = 1e-4 * trace;
    let inverse = (moment + DMat3::from_diagonal(DVec3::splat(ridge))).inverse();
    weights.clear();
    weights.extend(offsets.iter().map(|d| inverse * (*d - mean)));
    // The inverse is largest across the plane; squaring it twice leaves nothing else.
    let power = inverse * inverse * (1.0 / (inverse.x_axis.length_squared() + f64::MIN_POSITIVE));
    let power = power * power;
    let columns = [power.x_axis, power.y_axis, power.z_axis];
    let largest = columns
        .into_iter()
        .fold(DVec3::ZERO, |l, c| if c.length_squared() > l.length_squared() { c } else { l });
    let normal = largest.try_normalize()?;
    let thickness = normal.dot(moment * normal);
    let free = ridge / (thickness + ridge);
    weights.iter().all(|f| f.is_finite()).then_some((normal, free))
}

/// Gives the open part of the gradient, across the plane of the corners, the value that makes the whole as much
/// of a rotation as it can be: `t' G n = -n' G t` for all t in the plane. Left at zero, every rotation of the plane
/// would look like a shear, and the bound for triangles that turn together would be hundreds of times too small.
fn complete_as_rotation(gradient: &mut [f64], row: usize, n: DVec3, free: f64) {
    for k in 0..row {
        let entry = |c: usize, j: usize| gradient[(3 * c + j) * row + k];
        // G' n, without its part along n.
        let turned = DVec3::from_array(std::array::from_fn(|j| (0..3).map(|c| n[c] * entry(c, j)).sum()));
        let tilt = (turned - n * turned.dot(n)) * -free;
        for c in 0..3 {
            for j in 0..3 {
                gradient[(3 * c + j) * row + k] += tilt[c] * n[j];
            }
        }
    }
}

/// Gram matrix of the 6 x r matrix whose column k holds the Mandel components of the symmetric part of mode
/// k's gradient (scaled so that `|u u'|` has norm 1 for a unit vector u).
pub(super) type StrainGram = [[f64; 6]; 6];

fn strain_gram(gradient: &[f64], row: usize) -> StrainGram {
    let g = |c: usize, j: usize| &gradient[(3 * c + j) * row..][..row];
    let half_root = std::f64::consts::FRAC_1_SQRT_2;
    let mut gram = [[0.0; 6]; 6];
    let (xx, yy, zz) = (g(0, 0), g(1, 1), g(2, 2));
    let shears = [(g(1, 2), g(2, 1)), (g(0, 2), g(2, 0)), (g(0, 1), g(1, 0))];
    for start in (0..row).step_by(LANES) {
        let mut m = [[0.0; LANES]; 6];
        for i in 0..LANES {
            let k = start + i;
            (m[0][i], m[1][i], m[2][i]) = (xx[k], yy[k], zz[k]);
            for (slot, (a, b)) in m[3..].iter_mut().zip(shears) {
                slot[i] = (a[k] + b[k]) * half_root;
            }
        }
        for i in 0..6 {
            for j in i..6 {
                gram[i][j] += (0..LANES).map(|l| m[i][l] * m[j][l]).sum::<f64>();
            }
        }
    }
    for i in 0..6 {
        for j in 0..i {
            gram[i][j] = gram[j][i];
        }
    }
    gram
}

/// An upper bound of `max over unit u of |G(u)'u|`: the root of the largest eigenvalue, bounded from above by
/// `(sum of eigenvalues^8)^(1/8)` through two squarings; power iteration would approach from below.
fn largest_rate(gram: &StrainGram, row: usize) -> f64 {
    let trace: f64 = (0..6).map(|i| gram[i][i]).sum();
    if trace == 0.0 {
        return VANISHED; // infinite or NaN traces fall through: their bound becomes 0
    }
    // In units of the trace: eigenvalues at most 1, the largest at least 1/6.
    let unit = gram.map(|r| r.map(|x| x / trace));
    let square = |m: &[[f64; 6]; 6]| -> [[f64; 6]; 6] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| m[i][k] * m[k][j]).sum()))
    };
    let fourth = square(&square(&unit));
    let eighth: f64 = fourth.iter().flatten().map(|x| x * x).sum();
    // Entries are wrong by at most (row + 8) eps of the trace, those of the two squares by 8 eps more. On an
    // eigenvalue of at least 1/6 of the trace, its fourth power at least 6^-4, this adds up to less than
    // (row + 64) 512 eps of the result.
    let largest = eighth.sqrt().sqrt().sqrt() * trace;
    largest.sqrt() * (1.0 + (row as f64 + 64.0) * 512.0 * f64::EPSILON) + VANISHED
}

/// Covers gradient entries whose squares underflow.
const VANISHED: f64 = 1e-150;

#[cfg(test)]
mod tests;
