//! Upper bounds of the radius of a triangle pair: the norm of a z at which two of its points meet, or with a clearance
//! are as near as it. They end refinement and are never part of a certified radius. [`RelativeModes`] also gives the
//! Gram matrix by which lower bounds choose directions.

use glam::{DMat3, DVec3};

use super::contact_estimate::{estimate_first_contact, estimate_first_nearness};
use super::pair_corners::PairCorners;
use crate::geometry::{TwoTriangles, nearest_to_origin};
use crate::model::mode_rows::{add_scaled, dot, gram, project};

/// A ray in q-space from the centre along which two triangles approach.
pub(super) struct Ray<'z> {
    /// The largest norm of interest.
    pub(super) farthest: f64,
    /// The distance that is sought: 0 for a contact.
    pub(super) distance: f64,
    /// Scratch of one row.
    pub(super) z: &'z mut [f64],
}

/// The relative modes of two points, one of each triangle. Owns its memory.
pub(super) struct RelativeModes {
    /// The relative modes: three rows.
    rows: Vec<f64>,
}

impl RelativeModes {
    pub(super) fn new(row_len: usize) -> Self {
        Self { rows: vec![0.0; 3 * row_len] }
    }

    /// Returns the Gram matrix of the relative modes of two points, which weights of the nine differences of corners define.
    pub(super) fn gram_at(&mut self, pair: &PairCorners<'_>, weights: &[f64; 9]) -> DMat3 {
        self.rows.fill(0.0);
        for i in 0..3 {
            let a: f64 = weights[3 * i..3 * i + 3].iter().sum();
            let b: f64 = weights[i..].iter().step_by(3).sum();
            if a != 0.0 {
                add_scaled(&mut self.rows, -a, pair.modes_a[i]);
            }
            if b != 0.0 {
                add_scaled(&mut self.rows, b, pair.modes_b[i]);
            }
        }
        gram(&self.rows)
    }

    /// Returns the smallest `|z|` that brings the two points with the given weights together, `z = -B^+ d`. Infinite if
    /// the points are together at rest, or the modes cannot move them in all directions (then [`Self::bound_along_ray`]
    /// may give an upper bound).
    pub(super) fn bound_at(
        &mut self,
        pair: &PairCorners<'_>,
        differences: &[DVec3; 9],
        weights: &[f64; 9],
    ) -> f64 {
        let gram = self.gram_at(pair, weights);
        let d: DVec3 = differences.iter().zip(weights).map(|(d, w)| *d * *w).sum();
        let scale = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        if gram.determinant() <= 1e-18 * scale * scale * scale {
            return f64::INFINITY;
        }
        let square = d.dot(gram.inverse() * d);
        if square > 0.0 { square.sqrt() } else { f64::INFINITY }
    }

    /// Whether the relative modes at the centroids move in all three directions.
    pub(super) fn can_reach_everywhere(&mut self, pair: &PairCorners<'_>) -> bool {
        self.bound_at(pair, &pair.differences(), &[1.0 / 9.0; 9]).is_finite()
    }

    /// Returns the norm of a z along which the closest points of the sub-triangles approach and at which the triangles first
    /// touch, or come as near as a distance: for rank 1 or 2, or modes that do not reach all directions. None if no
    /// such z is found up to `farthest`.
    pub(super) fn bound_along_ray(
        &mut self,
        pair: &PairCorners<'_>,
        sub_pair: &PairCorners<'_>,
        Ray { farthest, distance, z }: Ray<'_>,
    ) -> Option<f64> {
        let closest = nearest_to_origin(&sub_pair.differences());
        self.gram_at(sub_pair, &closest.weights);
        project(&self.rows, closest.point, z);
        let length = dot(z, z).sqrt();
        let velocities = |modes: &[&[f64]; 3]| {
            modes.map(|modes| {
                let along = |axis: usize| dot(&modes[axis * z.len()..][..z.len()], z) * (-farthest / length);
                DVec3::new(along(0), along(1), along(2))
            })
        };
        let (velocities_a, velocities_b) = (velocities(&pair.modes_a), velocities(&pair.modes_b));
        let at = |p: &[DVec3; 3], v: &[DVec3; 3], t: f64| std::array::from_fn(|i| p[i] + v[i] * t);
        let corners_at = |t| TwoTriangles {
            a: at(&pair.corners.a, &velocities_a, t),
            b: at(&pair.corners.b, &velocities_b, t),
        };
        let contact = if distance > 0.0 {
            estimate_first_nearness(corners_at, distance)
        } else {
            estimate_first_contact(corners_at)
        };
        contact.map(|t| t * farthest)
    }
}
