//! Fits an affine map to the modes of some points and bounds the residuals.

use glam::{DMat3, DVec3};

use crate::model::RoundingBound;
use crate::model::mode_rows::{dot, padded_rank, squared_distance};
use crate::model::rounding::norm_up;
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// An affine map of the modes of some points, `A_i = A_0 + G (p_i - p_0) + E_i`, with residuals E. Owns its memory.
pub(crate) struct AffineFit {
    instructions: InstructionSet,
    row_len: usize,
    /// The gradient: nine rows, `G_cj` at `3 c + j`.
    gradient: Vec<f64>,
    /// The residuals: three rows for each point.
    residuals: Vec<f64>,
    weights: Vec<DVec3>,
    /// An upper bound of the Frobenius norm of the gradient.
    frobenius: f64,
    /// The largest distance of a point from the first one.
    longest: f64,
}

impl AffineFit {
    pub(crate) fn new(row_len: usize) -> Self {
        debug_assert_eq!(row_len, padded_rank(row_len));
        Self {
            instructions: InstructionSet::default(),
            row_len,
            gradient: vec![0.0; 9 * row_len],
            residuals: Vec::new(),
            weights: Vec::new(),
            frobenius: 0.0,
            longest: 0.0,
        }
    }

    /// Fits points with these offsets from the first of them, and these modes. Returns false if all points coincide, or
    /// a weight is not finite.
    pub(crate) fn fit<'m>(&mut self, offsets: &[DVec3], modes: impl Fn(usize) -> &'m [f64]) -> bool {
        let Some(plane) = fit_gradient(offsets, &mut self.weights) else { return false };
        self.instructions.run(FitModes { fit: self, plane, offsets, modes });
        self.longest = offsets.iter().map(|d| d.length()).fold(0.0, f64::max);
        true
    }

    /// Sets the gradient and the residuals.
    #[inline(always)]
    fn fit_modes<'m>(&mut self, plane: Plane, offsets: &[DVec3], modes: impl Fn(usize) -> &'m [f64]) {
        let row_len = self.row_len;
        // Gradient: G[c][j] = sum_i weight_i[j] (A_i - A_0)[c], a row over the modes for each of 3 x 3 entries.
        let first = modes(0);
        self.gradient.fill(0.0);
        for (i, weight) in self.weights.iter().enumerate().skip(1) {
            let modes = modes(i);
            for c in 0..3 {
                let a = &modes[c * row_len..][..row_len];
                let a0 = &first[c * row_len..][..row_len];
                let rows = &mut self.gradient[3 * c * row_len..][..3 * row_len];
                let (g0, rest) = rows.split_at_mut(row_len);
                let (g1, g2) = rest.split_at_mut(row_len);
                for k in 0..row_len {
                    let difference = a[k] - a0[k];
                    g0[k] += weight.x * difference;
                    g1[k] += weight.y * difference;
                    g2[k] += weight.z * difference;
                }
            }
        }
        complete_as_rotation(&mut self.gradient, row_len, plane);
        // Residuals: E_i = (A_i - A_0) - G (p_i - p_0); that of the first is 0.
        self.residuals.clear();
        self.residuals.resize(3 * row_len * offsets.len(), 0.0);
        for (i, offset) in offsets.iter().enumerate().skip(1) {
            let modes = modes(i);
            for c in 0..3 {
                let a = &modes[c * row_len..][..row_len];
                let a0 = &first[c * row_len..][..row_len];
                let g = &self.gradient[3 * c * row_len..][..3 * row_len];
                let e = &mut self.residuals[(3 * i + c) * row_len..][..row_len];
                for k in 0..row_len {
                    let across = with_mutant!(g[row_len + k], AffineResidualOfOtherMap, g[k]);
                    let affine = offset.x * g[k] + offset.y * across + offset.z * g[2 * row_len + k];
                    e[k] = (a[k] - a0[k]) - affine;
                }
            }
        }
        self.frobenius = norm_up(dot(&self.gradient, &self.gradient), 9 * row_len);
    }

    /// Returns the gradient: nine rows, `G_cj` at `3 c + j`.
    pub(crate) fn gradient(&self) -> &[f64] {
        &self.gradient
    }

    /// Returns an upper bound of the Frobenius norm of the gradient.
    pub(super) fn frobenius(&self) -> f64 {
        self.frobenius
    }

    /// Returns `|E_j - E_i|^2`, rounded to nearest.
    pub(super) fn squared_residual(&self, i: usize, j: usize) -> f64 {
        let width = 3 * self.row_len;
        squared_distance(&self.residuals[i * width..][..width], &self.residuals[j * width..][..width])
    }

    /// Returns an upper bound of `|E_j - E_i|`, given [`Self::squared_residual`], apart from the rounding of residuals
    /// relative to the scaled modes: for that rounding the affine bound adds [`RoundingBound::per_norm`] a second time.
    ///
    /// Rounding of the residuals is relative to the scaled modes and to `|G| |p_i - p_0|`. Corners of sub-triangles are
    /// themselves rounded, which moves both the offsets here and the directions in the bound. The roundings of two residuals and their
    /// offsets are below 14 units of 2^-53 of 32. The difference of two offsets and a direction of the bound are gaps of two corners
    /// each, whose rounding is at most `at_rest`: two of the four.
    pub(super) fn residual_up(&self, squared_residual: f64, rounding: &RoundingBound) -> f64 {
        let moved = 16.0 * f64::EPSILON * self.longest + 4.0 * rounding.at_rest(DVec3::ONE);
        norm_up(squared_residual, 3 * self.row_len)
            + with_mutant!(moved * self.frobenius, AffineResidualExact, 0.0)
    }
}

/// Fits the modes of points whose weights and plane are known.
struct FitModes<'f, F> {
    fit: &'f mut AffineFit,
    plane: Plane,
    offsets: &'f [DVec3],
    modes: F,
}

impl<'m, F: Fn(usize) -> &'m [f64]> Kernel for FitModes<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        self.fit.fit_modes(self.plane, self.offsets, self.modes);
    }
}

/// The plane in which points (nearly) lie.
#[derive(Clone, Copy)]
struct Plane {
    normal: DVec3,
    /// The share of the gradient across the plane that the points do not determine: 1 if they lie in a plane, 0 if they fill
    /// space.
    undetermined: f64,
}

/// Computes the weights of a regularised least-squares fit of a gradient to values at points, `G = sum_i value_i weights_i'`.
/// None if all points coincide, or a weight is not finite.
fn fit_gradient(offsets: &[DVec3], weights: &mut Vec<DVec3>) -> Option<Plane> {
    let mean = offsets.iter().sum::<DVec3>() / offsets.len() as f64;
    let mut moment = DMat3::ZERO;
    for d in offsets {
        let d = *d - mean;
        moment += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
    // Points that nearly lie in a plane do not determine the gradient across it; the regularisation
    // keeps that part small instead of fitting noise.
    let ridge = 1e-4 * trace;
    let inverse = (moment + DMat3::from_diagonal(DVec3::splat(ridge))).inverse();
    weights.clear();
    weights.extend(offsets.iter().map(|d| inverse * (*d - mean)));
    // The inverse is largest across the plane; its other parts nearly vanish in its fourth power.
    let power = inverse * inverse * (1.0 / (inverse.x_axis.length_squared() + f64::MIN_POSITIVE));
    let power = power * power;
    let columns = [power.x_axis, power.y_axis, power.z_axis];
    let largest = columns
        .into_iter()
        .fold(DVec3::ZERO, |l, c| if c.length_squared() > l.length_squared() { c } else { l });
    let normal = largest.try_normalize()?;
    let thickness = normal.dot(moment * normal);
    let undetermined = ridge / (thickness + ridge);
    weights.iter().all(|w| w.is_finite()).then_some(Plane { normal, undetermined })
}

/// Sets the undetermined part of the gradient, across the plane of the points, so that the whole is as close to a
/// rotation as possible: `t' G n = -n' G t` for all t in the plane. If it were zero, every rotation of the plane
/// would look like a shear, and the bound for triangles that rotate together would be hundreds of times too small.
#[inline(always)]
fn complete_as_rotation(gradient: &mut [f64], row_len: usize, Plane { normal: n, undetermined }: Plane) {
    for k in 0..row_len {
        let entry = |c: usize, j: usize| gradient[(3 * c + j) * row_len + k];
        // G' n, without its part along n.
        let turned = DVec3::from_array(std::array::from_fn(|j| (0..3).map(|c| n[c] * entry(c, j)).sum()));
        let tilt = (turned - n * turned.dot(n)) * -undetermined;
        for c in 0..3 {
            for j in 0..3 {
                gradient[(3 * c + j) * row_len + k] += tilt[c] * n[j];
            }
        }
    }
}

#[cfg(test)]
mod tests;
