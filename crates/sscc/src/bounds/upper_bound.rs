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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::tests::random::Random;

    /// Weights of differences define a point of each triangle. The smallest z that brings both together has
    /// the norm of `B^+ d`.
    #[test]
    fn points_meet_at_the_smallest_norm() {
        const ROW_LEN: usize = 8;
        for case in 0..300 {
            let random = &mut Random::new(case);
            let speed = random.power(-6.0, 6.0);
            let corners = [(); 2].map(|()| [(); 3].map(|()| random.vector()));
            let mut modes: Vec<Vec<f64>> = (0..6)
                .map(|_| (0..3 * ROW_LEN).map(|_| (random.uniform() - 0.5) * speed).collect())
                .collect();
            let is_flat = case % 5 == 0;
            if is_flat {
                modes.iter_mut().for_each(|rows| rows[2 * ROW_LEN..].fill(0.0));
            }
            let of = |v: usize| modes[v].as_slice();
            let pair = PairCorners {
                corners: TwoTriangles { a: corners[0], b: corners[1] },
                modes_a: [of(0), of(1), of(2)],
                modes_b: [of(3), of(4), of(5)],
            };
            // Some points are corners.
            let [wa, wb] = [3, 4].map(|n| if case % n == 0 { DVec3::Y } else { random.weights() });
            let weights: [f64; 9] = std::array::from_fn(|ij| wa[ij / 3] * wb[ij % 3]);
            let relative = |c: usize, k: usize| -> f64 {
                (0..3)
                    .map(|v| modes[3 + v][c * ROW_LEN + k] * wb[v] - modes[v][c * ROW_LEN + k] * wa[v])
                    .sum()
            };
            let entry =
                |c: usize, e: usize| -> f64 { (0..ROW_LEN).map(|k| relative(c, k) * relative(e, k)).sum() };
            let column = |e: usize| DVec3::new(entry(0, e), entry(1, e), entry(2, e));
            let gram = DMat3::from_cols(column(0), column(1), column(2));
            let mut rows = RelativeModes::new(ROW_LEN);
            let found = rows.gram_at(&pair, &weights);
            assert!(found.abs_diff_eq(gram, 1e-13 * speed * speed), "case {case}: {found} {gram}");
            let differences = pair.differences();
            let bound = rows.bound_at(&pair, &differences, &weights);
            assert_eq!(rows.can_reach_everywhere(&pair), !is_flat, "case {case}");
            if is_flat {
                assert_eq!(bound, f64::INFINITY, "case {case}");
                continue;
            }
            let d: DVec3 = (0..3).map(|v| corners[1][v] * wb[v] - corners[0][v] * wa[v]).sum();
            let expected = d.dot(gram.inverse() * d).sqrt();
            assert!((bound / expected - 1.0).abs() < 1e-8, "case {case}: {bound:e}, not {expected:e}");
            // Points that are together at rest prove nothing about others.
            let together = [DVec3::ZERO; 9];
            assert_eq!(rows.bound_at(&pair, &together, &weights), f64::INFINITY, "case {case}");
        }
    }
}
