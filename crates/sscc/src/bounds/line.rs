//! How far a shape can move along a straight path before two of its parts can meet: conservative advancement.
//!
//! Vertex v is at `x_v + t w_v`. For a fixed direction n two triangles stay apart as long as all nine pairs of
//! corners do: `n.(d_ab + t (w_b - w_a)) > 0`, which is linear in t. So a direction that separates them at t_0
//! certifies them up to some t_1; there a new direction is chosen, and so on until that gains nothing.

use glam::DVec3;

use crate::ReducedModel;
use crate::geometry::{Aabb, nearest_to_origin};
use crate::model::{direction, quotient_down};

/// A step that gains less than this share of t is the last one: with it t is about where the triangles meet.
const GAIN: f64 = 1e-4;

/// Steps at the most; what is reached by then is safe, if not as far as it could be. A few dozen are common.
const STEPS: usize = 1000;

/// The vertices of a model on the way from `center` through q: at `x + t w`, `center` at t = 0 and q at t = 1.
pub(crate) struct Path {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) velocities: Vec<DVec3>,
    /// By how much a computed gap along a direction with components up to 1 may differ from the linear one:
    /// at most `rest + rate t`.
    rest: f64,
    rate: f64,
    /// Up to this t positions stay in range.
    pub(crate) farthest: f64,
}

impl Path {
    pub(crate) fn new(model: &ReducedModel, center: &[f64], q: &[f64]) -> Self {
        let offset: Vec<f64> = q.iter().zip(center).map(|(q, c)| q - c).collect();
        let vertices = 0..model.mesh().rest_positions().len() as u32;
        let velocity = |v| {
            let modes = model.modes().of_vertex(v);
            modes.iter().zip(&offset).fold(DVec3::ZERO, |w, (u, x)| w + *u * *x)
        };
        let (reach, moved) = (model.reach(center), model.moved(&offset));
        // Positions, velocities, q itself, gaps and sums of t are rounded at most 4 (r + 16) times, two vertices,
        // three components each; and once more as much as room.
        let gamma = 12.0 * (4 * q.len() + 64) as f64 * f64::EPSILON;
        Self {
            positions: vertices.clone().map(|v| model.position(v, center)).collect(),
            velocities: vertices.map(velocity).collect(),
            rest: gamma * reach + f64::MIN_POSITIVE,
            rate: gamma * moved + f64::MIN_POSITIVE,
            farthest: ((crate::limits::LARGEST / 2.0 - reach) / moved.max(f64::MIN_POSITIVE)).max(0.0),
        }
    }

    /// The t up to which a gap that is at least `gap` at `t` and closes no faster than `-opening` stays positive.
    #[inline]
    pub(crate) fn closes_at(&self, t: f64, gap: f64, opening: f64) -> f64 {
        let gap = right_or!(gap - self.rest - t * self.rate, PathExact, gap);
        let opening = right_or!(opening - self.rate, PathExact, opening);
        if gap.is_nan() || gap <= 0.0 {
            0.0
        } else if opening >= 0.0 {
            f64::INFINITY
        } else {
            t + quotient_down(gap, -opening)
        }
    }

    /// Follows two triangles that do not meet before `t`: infinite when they do not meet before `goal`; else a scale
    /// before which they do not, about where they meet.
    pub(crate) fn follow(&self, x: [u32; 3], y: [u32; 3], mut t: f64, goal: f64) -> f64 {
        let (d, rates) = (self.differences(&self.positions, x, y), self.differences(&self.velocities, x, y));
        for _ in 0..STEPS {
            let now: [DVec3; 9] = std::array::from_fn(|i| d[i] + rates[i] * t);
            let separated_until = |n: DVec3| {
                let until = now.iter().zip(&rates).map(|(d, w)| self.closes_at(t, n.dot(*d), n.dot(*w)));
                until.fold(f64::INFINITY, f64::min)
            };
            // Each direction is a proof by itself. Between the centroids is cheap and often enough; the one that
            // separates them best at t leads to the contact.
            if direction(now.iter().sum()).is_some_and(|n| separated_until(n) >= goal) {
                return f64::INFINITY;
            }
            let Some(n) = direction(nearest_to_origin(&now).point) else { return t };
            let until = separated_until(n);
            if until >= goal {
                return f64::INFINITY;
            }
            if until <= t * (1.0 + GAIN) {
                return until.max(t);
            }
            t = until;
        }
        t
    }

    /// A t before which some axis separates all points with positions and velocities in two pairs of boxes.
    #[inline]
    pub(crate) fn boxes_apart(&self, x: &MovingAabb, y: &MovingAabb) -> f64 {
        let mut bound = 0.0_f64;
        let gap = |x: &Aabb, y: &Aabb| y.lower - x.upper;
        for (x, y) in [(x, y), (y, x)] {
            let (gap, opening) = (gap(&x.positions, &y.positions), gap(&x.velocities, &y.velocities));
            for axis in 0..3 {
                if gap[axis] > 0.0 {
                    bound = bound.max(self.closes_at(0.0, gap[axis], opening[axis]));
                }
            }
        }
        bound
    }

    fn differences(&self, of: &[DVec3], x: [u32; 3], y: [u32; 3]) -> [DVec3; 9] {
        let (x, y) = (x.map(|v| of[v as usize]), y.map(|v| of[v as usize]));
        std::array::from_fn(|i| y[i % 3] - x[i / 3])
    }
}

/// The boxes of some points at the start of a line and of their velocities.
#[derive(Clone, Copy)]
pub(crate) struct MovingAabb {
    pub(crate) positions: Aabb,
    pub(crate) velocities: Aabb,
}

impl MovingAabb {
    pub(crate) const EMPTY: Self = Self { positions: Aabb::EMPTY, velocities: Aabb::EMPTY };

    /// The boxes of both sets of points.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            positions: self.positions.union(&other.positions),
            velocities: self.velocities.union(&other.velocities),
        }
    }
}
