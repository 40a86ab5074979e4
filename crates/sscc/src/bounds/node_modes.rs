//! The AABB of a node, an affine map fitted to its modes, and a bound of the residuals.

use glam::{DMat3, DVec3};

use crate::geometry::Aabb;
use crate::model::ScaledModel;
use crate::model::mode_rows::{add_scaled, dot};
use crate::model::rounding::{ROUND_UP, norm_up};

/// The AABB of a node at rest with centre c, and its modes `A_i = A_c + G (p_i - c) + E_i`. Rows are over the modes.
pub(crate) struct NodeModes {
    pub(crate) center: DVec3,
    /// Half extents of the AABB, rounded up.
    pub(super) half: DVec3,
    /// An upper bound of the residuals: `|E_i' dir| <= dir.abs().dot(residual)`.
    pub(super) residual: DVec3,
    /// Modes at the centre: three rows.
    pub(crate) modes: Vec<f64>,
    /// Three rows for each direction j: `(G e_j)_c` at `3 j + c`.
    pub(crate) gradient: Vec<f64>,
}

impl NodeModes {
    /// Fits the vertices of a node.
    pub(super) fn fit(model: &ScaledModel, vertices: &[u32]) -> Self {
        let row_len = model.row_len;
        let aabb = Aabb::of_points(vertices.iter().map(|&i| model.positions[i as usize]));
        let center = aabb.center();
        // A little larger than the difference of the rounded corners.
        let half = (aabb.upper - center).max(center - aabb.lower) * ROUND_UP;
        let count = vertices.len() as f64;
        let mean = vertices.iter().map(|&i| model.positions[i as usize] - center).sum::<DVec3>() / count;
        let mut moment = DMat3::ZERO;
        for &i in vertices {
            let d = model.positions[i as usize] - center - mean;
            moment += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        }
        let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        // Vertices nearly in a plane do not determine the gradient across it: keep that part small.
        let inverse = (moment + DMat3::from_diagonal(DVec3::splat(1e-4 * trace))).inverse();
        let mut modes = vec![0.0; 3 * row_len];
        let mut gradient = vec![0.0; 9 * row_len];
        for &i in vertices {
            let a = model.modes(i);
            let weight = inverse * (model.positions[i as usize] - center - mean);
            add_scaled(&mut modes, 1.0 / count, a);
            if weight.is_finite() {
                for (j, rows) in gradient.chunks_exact_mut(3 * row_len).enumerate() {
                    add_scaled(rows, weight[j], a);
                }
            }
        }
        for (j, rows) in gradient.chunks_exact(3 * row_len).enumerate() {
            add_scaled(&mut modes, -mean[j], rows);
        }
        let mut residual = DVec3::ZERO;
        let mut rest = vec![0.0; 3 * row_len];
        for &i in vertices {
            let offset = model.positions[i as usize] - center;
            rest.iter_mut().zip(model.modes(i)).zip(&modes).for_each(|((e, a), m)| *e = a - m);
            for (j, rows) in gradient.chunks_exact(3 * row_len).enumerate() {
                add_scaled(&mut rest, -offset[j], rows);
            }
            let norm = |axis: usize| {
                let e = &rest[axis * row_len..][..row_len];
                norm_up(dot(e, e), row_len)
            };
            residual = residual.max(DVec3::new(norm(0), norm(1), norm(2)));
        }
        // The rounding bound covers rounding of residuals and corners relative to the modes. This term covers rounding relative
        // to `|G| |h|`: that of residuals and of the projections of corners, about 40 units of 2^-53 of 128.
        let frobenius = norm_up(dot(&gradient, &gradient), 9 * row_len);
        let lost = with_mutant!(64.0 * f64::EPSILON * frobenius * half.length(), NodeFitExact, 0.0);
        residual += DVec3::splat(lost);
        Self { center, half, residual, modes, gradient }
    }

    /// Returns the vector between the closest points of the AABBs of two nodes, from this one to the other; 0 where they touch.
    pub(super) fn gap(&self, other: &Self) -> DVec3 {
        let (between, half) = (other.center - self.center, self.half + other.half);
        (between - half).max(DVec3::ZERO) + (between + half).min(DVec3::ZERO)
    }
}

#[cfg(test)]
mod tests;
