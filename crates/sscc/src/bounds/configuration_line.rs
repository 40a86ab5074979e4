//! Conservative advancement in q-space (Mirtich 1996): how far a shape can move along a straight line of configurations
//! before two of its triangles can meet.
//!
//! Vertex i is at `x_i + t w_i`. Along a fixed direction dir two triangles are separated as long as all nine pairs of
//! corners are: `dir.(d_ij + t (w_j - w_i)) > 0`, which is linear in t. So a direction that separates the triangles at
//! some t proves them separated up to a later t. There a new direction is chosen, until a step gains too little.

use glam::DVec3;

use crate::ReducedModel;
use crate::geometry::{Aabb, nearest_to_origin};
use crate::limits;
use crate::model::rounding::quotient_down;
use crate::model::scale_direction;

/// A step that gains at most this share of t is the last one: t is then close to the contact.
const MIN_GAIN: f64 = 1e-4;

/// Maximum number of steps. The t reached after them is certified, but may be smaller than the contact.
const MAX_STEPS: usize = 1000;

/// The vertices of a model along the line from `center` (t = 0) through q (t = 1): at `x + t w`.
pub(crate) struct ConfigurationLine {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) velocities: Vec<DVec3>,
    /// The rounding bound of a gap along a direction with components up to 1 is `at_rest + per_step t`.
    at_rest: f64,
    /// The growth of this rounding bound with t.
    per_step: f64,
    /// Up to this t positions stay in the range of [`limits`].
    pub(crate) farthest: f64,
}

impl ConfigurationLine {
    pub(crate) fn new(model: &ReducedModel, center: &[f64], q: &[f64]) -> Self {
        let offset: Vec<f64> = q.iter().zip(center).map(|(q, c)| q - c).collect();
        let vertices = 0..model.mesh().rest_positions().len() as u32;
        let velocity = |i| {
            let modes = model.modes().of_vertex(i);
            modes.iter().zip(&offset).fold(DVec3::ZERO, |w, (u, x)| w + *u * *x)
        };
        let (reach, moved) = (model.reach(center), model.displacement_bound(&offset));
        // Positions, velocities, q itself, gaps and sums of t are rounded at most 4 (r + 16) times, for two vertices and three
        // components each. A factor of 2 is a reserve.
        let gamma = 12.0 * (4 * q.len() + 64) as f64 * f64::EPSILON;
        Self {
            positions: vertices.clone().map(|i| model.position(i, center)).collect(),
            velocities: vertices.map(velocity).collect(),
            at_rest: gamma * reach + f64::MIN_POSITIVE,
            per_step: gamma * moved + f64::MIN_POSITIVE,
            farthest: ((limits::LARGEST / 2.0 - reach) / moved.max(f64::MIN_POSITIVE)).max(0.0),
        }
    }

    /// Returns the t until which a gap certainly stays positive. At `t` the gap is at least `gap`, and its rate is at
    /// least `opening`. Returns 0 if the gap is not certainly positive at `t`.
    #[inline]
    pub(crate) fn open_until(&self, t: f64, gap: f64, opening: f64) -> f64 {
        let gap = with_mutant!(gap - self.at_rest - t * self.per_step, LineExact, gap);
        let opening = with_mutant!(opening - self.per_step, LineExact, opening);
        if gap.is_nan() || gap <= 0.0 {
            0.0
        } else if opening >= 0.0 {
            f64::INFINITY
        } else {
            t + quotient_down(gap, -opening)
        }
    }

    /// Advances a triangle pair that does not meet before `t`. Returns infinity if it does not meet before `goal`, else
    /// a t before which it does not meet, close to the contact.
    pub(crate) fn advance(&self, a: [u32; 3], b: [u32; 3], mut t: f64, goal: f64) -> f64 {
        let (d, rates) = (differences(&self.positions, a, b), differences(&self.velocities, a, b));
        for _ in 0..MAX_STEPS {
            let now: [DVec3; 9] = std::array::from_fn(|ij| d[ij] + rates[ij] * t);
            let separates_until = |dir: DVec3| {
                let until = now.iter().zip(&rates).map(|(d, w)| self.open_until(t, dir.dot(*d), dir.dot(*w)));
                until.fold(f64::INFINITY, f64::min)
            };
            // Each direction is a proof by itself. The one between the centroids is cheap and often sufficient; the one
            // between the closest points at t leads to the contact.
            if scale_direction(now.iter().sum()).is_some_and(|dir| separates_until(dir) >= goal) {
                return f64::INFINITY;
            }
            let Some(dir) = scale_direction(nearest_to_origin(&now).point) else { return t };
            let until = separates_until(dir);
            if until >= goal {
                return f64::INFINITY;
            }
            if until <= t * (1.0 + MIN_GAIN) {
                return until.max(t);
            }
            t = until;
        }
        t
    }

    /// Returns a t before which some axis separates all points whose positions and velocities lie in two pairs of AABBs.
    #[inline]
    pub(crate) fn aabbs_separated_until(&self, a: &MovingAabb, b: &MovingAabb) -> f64 {
        let mut bound = 0.0_f64;
        let gap = |a: &Aabb, b: &Aabb| b.lower - a.upper;
        for (a, b) in [(a, b), (b, a)] {
            let (gap, opening) = (gap(&a.positions, &b.positions), gap(&a.velocities, &b.velocities));
            for axis in 0..3 {
                if gap[axis] > 0.0 {
                    bound = bound.max(self.open_until(0.0, gap[axis], opening[axis]));
                }
            }
        }
        bound
    }
}

/// Returns the nine differences of the vectors of two triangles' vertices.
#[inline]
fn differences(of: &[DVec3], a: [u32; 3], b: [u32; 3]) -> [DVec3; 9] {
    let (a, b) = (a.map(|i| of[i as usize]), b.map(|j| of[j as usize]));
    std::array::from_fn(|ij| b[ij % 3] - a[ij / 3])
}

/// The AABBs of some points at the start of a line and of their velocities.
#[derive(Clone, Copy)]
pub(crate) struct MovingAabb {
    pub(crate) positions: Aabb,
    pub(crate) velocities: Aabb,
}

impl MovingAabb {
    pub(crate) const EMPTY: Self = Self { positions: Aabb::EMPTY, velocities: Aabb::EMPTY };

    /// Returns the AABBs of both sets of points.
    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            positions: self.positions.union(&other.positions),
            velocities: self.velocities.union(&other.velocities),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Metric, Modes, TriMesh};

    /// With one mode the rounding bound of a gap is below a thousand units of the reach, and positions stay in range up to the
    /// largest number over the displacement.
    #[test]
    fn margins_of_lines_are_small() {
        let p = [DVec3::ZERO, DVec3::X, DVec3::Y].to_vec();
        let mesh = TriMesh::new(p, vec![[0, 1, 2]]).unwrap();
        for moved in [1e-3, 1.0, 1e6] {
            let modes = Modes::new(1, vec![DVec3::Z * moved; 3]).unwrap();
            let model = ReducedModel::with_metric(mesh.clone(), modes, Metric::identity(1)).unwrap();
            let line = ConfigurationLine::new(&model, &[0.0], &[1.0]);
            let unit = 1000.0 * f64::EPSILON;
            assert!(line.at_rest <= unit && line.per_step <= unit * moved, "{moved}");
            let farthest = limits::LARGEST / 2.0 / moved;
            assert!((line.farthest / farthest - 1.0).abs() < 1e-12, "{moved}: {:e}", line.farthest);
        }
    }
}
