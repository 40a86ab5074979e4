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
    use crate::bounds::tests::random::Random;
    use crate::{Metric, Modes, TriMesh};

    /// Returns the line of two triangles: corners 0 to 2 and 3 to 5.
    fn line_of(positions: [DVec3; 6], velocities: [DVec3; 6], margin: f64) -> ConfigurationLine {
        let (positions, velocities) = (positions.to_vec(), velocities.to_vec());
        ConfigurationLine { positions, velocities, at_rest: margin, per_step: margin, farthest: f64::MAX }
    }

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

    /// A line begins at the centre, with the velocities from there to q. Its rounding bounds are those of 4
    /// (r + 16) roundings for two vertices and three components.
    #[test]
    fn lines_lead_from_the_centre_to_q() {
        for rank in [1, 3, 70] {
            let random = &mut Random::new(rank as u64);
            let p: Vec<DVec3> = (0..3).map(|_| random.vector() * 8.0).collect();
            let displacements: Vec<DVec3> = (0..3 * rank).map(|_| random.vector()).collect();
            let [center, q] =
                [(); 2].map(|()| (0..rank).map(|_| 2.0 * random.uniform() - 1.0).collect::<Vec<f64>>());
            let mesh = TriMesh::new(p.clone(), vec![[0, 1, 2]]).unwrap();
            let modes = Modes::new(rank, displacements.clone()).unwrap();
            let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
            let line = ConfigurationLine::new(&model, &center, &q);
            let at =
                |v: usize, q: &[f64]| (0..rank).fold(p[v], |x, k| x + displacements[v * rank + k] * q[k]);
            for v in 0..3 {
                let (first, last) = (at(v, &center), at(v, &q));
                assert!((line.positions[v] - first).abs().max_element() <= 1e-12, "{rank}: {v}");
                assert!((line.velocities[v] - (last - first)).abs().max_element() <= 1e-12, "{rank}: {v}");
            }
            let largest =
                |k: usize| (0..3).fold(DVec3::ZERO, |u, v| u.max(displacements[v * rank + k].abs()));
            let moved = |of: &dyn Fn(usize) -> f64| -> f64 {
                (0..rank).map(|k| largest(k).max_element() * of(k).abs()).sum()
            };
            let reach =
                p.iter().fold(DVec3::ZERO, |x, p| x.max(p.abs())).max_element() + moved(&|k| center[k]);
            let moved = moved(&|k| q[k] - center[k]);
            let roundings = (4 * (rank + 16) * 2 * 3) as f64 * (f64::EPSILON / 2.0);
            for (found, size) in [(line.at_rest, reach), (line.per_step, moved)] {
                assert!(
                    found >= roundings * size * 1.99 && found <= roundings * size * 5.0,
                    "{rank}: {found:e}"
                );
            }
        }
    }

    /// Even where all positions are 0, or nothing moves, rounding bounds are positive: a gap of 0 is none.
    #[test]
    fn rounding_bounds_are_positive() {
        let mesh = TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, 2]]).unwrap();
        let modes = Modes::new(1, vec![DVec3::X; 3]).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
        let line = ConfigurationLine::new(&model, &[0.0], &[0.0]);
        assert!(line.at_rest > 0.0 && line.per_step > 0.0);
        assert_eq!(line.open_until(0.0, 0.0, 1.0), 0.0);
    }

    /// The rest of the range, after the positions at the centre, is what the displacements may use.
    #[test]
    fn lines_end_within_the_range() {
        let modes = Modes::new(1, vec![DVec3::Y * 4.0; 3]).unwrap();
        for (share, left) in [(0.25, 0.25), (0.5, 0.0), (0.75, 0.0), (1.0, 0.0)] {
            let p = vec![DVec3::ZERO, DVec3::X * (limits::LARGEST * share), DVec3::Y];
            let mesh = TriMesh::new(p, vec![[0, 1, 2]]).unwrap();
            let model = ReducedModel::with_metric(mesh, modes.clone(), Metric::identity(1)).unwrap();
            let farthest = ConfigurationLine::new(&model, &[0.0], &[1.0]).farthest;
            let expected = limits::LARGEST * left / 4.0;
            assert!((farthest - expected).abs() <= 1e-12 * expected, "{share}: {farthest:e}");
        }
    }

    /// Both rounding bounds are subtracted: the gap is then 0.5 at t = 2 if it is 1.
    #[test]
    fn gaps_are_open_until_they_close() {
        let line = ConfigurationLine {
            positions: Vec::new(),
            velocities: Vec::new(),
            at_rest: 0.25,
            per_step: 0.125,
            farthest: f64::MAX,
        };
        for opening in [0.125, 0.2, 3.0] {
            assert_eq!(line.open_until(2.0, 1.0, opening), f64::INFINITY, "{opening}");
        }
        for (opening, expected) in [(0.0, 6.0), (0.0625, 10.0), (-0.375, 3.0)] {
            let until = line.open_until(2.0, 1.0, opening);
            assert!(until <= expected && until > expected - 1e-12, "{opening}: {until}");
        }
        // Not certainly positive at t, whatever its rate.
        for (gap, opening) in
            [0.5, 0.3, 0.0, -1.0, f64::NAN].into_iter().flat_map(|gap| [(gap, 3.0), (gap, -3.0)])
        {
            assert_eq!(line.open_until(2.0, gap, opening), 0.0, "{gap} {opening}");
        }
    }

    #[test]
    fn differences_are_those_of_all_pairs_of_corners() {
        let of: Vec<DVec3> = (0..7).map(|i| DVec3::new(f64::from(i), f64::from(i * i), -1.0)).collect();
        let (a, b) = ([4, 0, 6], [2, 5, 1]);
        let found = differences(&of, a, b);
        for (i, j) in (0..9).map(|ij| (ij / 3, ij % 3)) {
            assert_eq!(found[3 * i + j], of[b[j] as usize] - of[a[i] as usize], "{i} {j}");
        }
    }

    /// A triangle moves along a line, in any direction, until one of its corners meets the inside of the
    /// other triangle.
    #[test]
    fn triangles_advance_up_to_their_contact() {
        for case in 0..200 {
            let random = &mut Random::new(case);
            let normal = random.vector().normalize();
            let (along, across) = normal.any_orthonormal_pair();
            let middle = random.vector() * 3.0;
            let at = |x: f64, y: f64, z: f64| middle + along * x + across * y + normal * z;
            let first = 0.05 + 0.9 * random.uniform();
            let (i, j) = (random.below(3), random.below(3));
            let velocity = at(4.0 * random.uniform() - 2.0, 4.0 * random.uniform() - 2.0, -1.0) - middle;
            let (mut moving, mut still) = ([DVec3::ZERO; 3], [DVec3::ZERO; 3]);
            moving[i] = at(0.0, 0.0, 0.0);
            moving[(i + 1) % 3] = at(0.5, 0.2, 1.0);
            moving[(i + 2) % 3] = at(-0.3, 0.4, 1.2);
            still[j] = at(1.0, 0.1, 0.0);
            still[(j + 1) % 3] = at(-0.6, 0.9, 0.0);
            still[(j + 2) % 3] = at(-0.4, -1.0, 0.0);
            let positions = [moving.map(|p| p - velocity * first), still].concat();
            let velocities = [[velocity; 3], [DVec3::ZERO; 3]].concat();
            let all = |of: Vec<DVec3>| -> [DVec3; 6] { std::array::from_fn(|v| of[v]) };
            let line = line_of(all(positions), all(velocities), 1e-15);
            for (a, b) in [([0, 1, 2], [3, 4, 5]), ([5, 3, 4], [1, 2, 0])] {
                let found = line.advance(a, b, 0.0, 2.0);
                assert!(
                    found <= first * (1.0 + 1e-12) && found >= first * (1.0 - 1e-6),
                    "case {case}: {found}, not {first}"
                );
                assert_eq!(line.advance(a, b, 0.0, 0.99 * first), f64::INFINITY, "case {case}");
            }
        }
    }

    /// Of the gaps between two boxes along three axes, in both orders, the one that stays open longest
    /// counts.
    #[test]
    fn boxes_are_separate_until_their_last_gap_closes() {
        let line = line_of([DVec3::ZERO; 6], [DVec3::ZERO; 6], 0.0);
        let mut finite = 0;
        for case in 0..500 {
            let random = &mut Random::new(case);
            let [a, b] = [(); 2].map(|()| {
                let [positions, velocities] = [(); 2].map(|()| {
                    let lower = random.vector() * 2.0;
                    Aabb { lower, upper: lower + random.vector().abs() }
                });
                MovingAabb { positions, velocities }
            });
            let mut expected = 0.0_f64;
            for (low, high) in [(a, b), (b, a)] {
                let gap = high.positions.lower - low.positions.upper;
                let opening = high.velocities.lower - low.velocities.upper;
                for axis in (0..3).filter(|axis| gap[*axis] > 0.0) {
                    let until = if opening[axis] < 0.0 { -gap[axis] / opening[axis] } else { f64::INFINITY };
                    expected = expected.max(until);
                }
            }
            let found = line.aabbs_separated_until(&a, &b);
            let is_near = found <= expected && found >= expected * (1.0 - 1e-14);
            assert!(found == expected || is_near, "case {case}: {found}, not {expected}");
            finite += usize::from(found > 0.0 && found.is_finite());
        }
        assert!(finite > 50, "{finite}");
    }
}
