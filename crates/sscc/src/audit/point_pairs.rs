//! Pairs of points of two triangles: the smallest `|z|` that brings the points together, in closed form, or as near as
//! a given distance, by iteration.

use glam::{DMat3, DVec3};

use super::random::Random;
use crate::filter::SimplexPair;
use crate::model::ScaledModel;

/// Steps of the barycentric grid along each edge.
pub(super) const GRID: usize = 6;

/// Number of iterations that find the direction in which two points are a given distance apart.
const STEPS_TO_DISTANCE: usize = 8;

/// Points of two simplices, given by barycentric weights.
pub(super) struct PointPairs<'a> {
    pub(super) scaled: &'a ScaledModel,
    pub(super) simplices: SimplexPair<u32>,
    /// The distance that is sought; 0 for a contact.
    pub(super) distance: f64,
}

/// Barycentric weights of a point of each simplex.
#[derive(Clone, Copy)]
pub(super) struct Weights {
    pub(super) a: DVec3,
    pub(super) b: DVec3,
}

/// The relative position and modes of two points.
pub(super) struct Relative {
    /// The difference d at rest.
    pub(super) difference: DVec3,
    /// The columns of B.
    pub(super) modes: Vec<DVec3>,
}

impl Weights {
    /// The centroids.
    pub(super) const CENTROIDS: Self = Self { a: DVec3::splat(1.0 / 3.0), b: DVec3::splat(1.0 / 3.0) };

    /// Returns random points.
    pub(super) fn random(random: &mut Random) -> Self {
        let mut point = || {
            let w = DVec3::new(random.uniform(), random.uniform(), random.uniform());
            w / (w.x + w.y + w.z).max(f64::MIN_POSITIVE)
        };
        Self { a: point(), b: point() }
    }

    /// Returns the weights of both points, changed alike.
    pub(super) fn map(self, mut f: impl FnMut(DVec3) -> DVec3) -> Self {
        Self { a: f(self.a), b: f(self.b) }
    }
}

impl PointPairs<'_> {
    /// Returns the difference d and the relative modes B of two points.
    pub(super) fn relative(&self, weights: Weights) -> Relative {
        let row_len = self.scaled.row_len;
        let mut difference = DVec3::ZERO;
        let mut relative = vec![DVec3::ZERO; row_len];
        for (corners, weights, sign) in
            [(self.simplices.a, weights.a, -1.0), (self.simplices.b, weights.b, 1.0)]
        {
            for (&i, w) in corners.iter().zip(weights.to_array()) {
                let modes = self.scaled.modes(i);
                difference += self.scaled.positions[i as usize] * (w * sign);
                for (k, b) in relative.iter_mut().enumerate() {
                    *b += DVec3::new(modes[k], modes[row_len + k], modes[2 * row_len + k]) * (w * sign);
                }
            }
        }
        Relative { difference, modes: relative }
    }

    /// Returns the smallest `|z|` that brings the two points together, or as near as the distance; infinite if the
    /// modes cannot.
    pub(super) fn radius(&self, weights: Weights) -> f64 {
        let relative = self.relative(weights);
        let solved = relative.multiplier(self.distance);
        solved.map_or(f64::INFINITY, |(y, left)| left.dot(y).max(0.0).sqrt())
    }

    /// Returns the z of [`Self::radius`]; 0 if the modes cannot bring the points together.
    pub(super) fn solution(&self, weights: Weights) -> Vec<f64> {
        let relative = self.relative(weights);
        let (y, _) = relative.multiplier(self.distance).unwrap_or_default();
        relative.modes.iter().map(|b| -b.dot(y)).collect()
    }
}

impl Relative {
    /// Returns `y = (B B')^-1 d` and d, if B has full rank. For a distance D, a vector of length D along y is first subtracted
    /// from d: then the points are D apart in that direction, and no smaller z brings them as near. A few fixed-point iterations
    /// find the direction. With another direction the points come as near as D, too, but by a larger z. Returns zeros
    /// if the points are at most D apart at rest.
    fn multiplier(&self, distance: f64) -> Option<(DVec3, DVec3)> {
        let mut gram = DMat3::ZERO;
        for b in &self.modes {
            gram += DMat3::from_cols(*b * b.x, *b * b.y, *b * b.z);
        }
        let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        if gram.determinant() <= 1e-15 * trace * trace * trace || !trace.is_finite() {
            return None;
        }
        let (inverse, mut left) = (gram.inverse(), self.difference);
        if distance > 0.0 {
            if self.difference.length() <= distance {
                return Some((DVec3::ZERO, DVec3::ZERO));
            }
            for _ in 0..STEPS_TO_DISTANCE {
                left = self.difference - (inverse * left).normalize_or_zero() * distance;
            }
        }
        Some((inverse * left, left))
    }
}

/// Returns barycentric weights on a regular grid.
pub(super) fn grid() -> impl Iterator<Item = DVec3> {
    (0..=GRID).flat_map(|i| {
        (0..=GRID - i).map(move |j| DVec3::new(i as f64, j as f64, (GRID - i - j) as f64) / GRID as f64)
    })
}
