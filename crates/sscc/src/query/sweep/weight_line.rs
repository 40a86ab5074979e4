//! Configurations that differ in the weight of one mode, and how far their computed positions are from straight lines.
//!
//! The proof of a sweep. Let w go from w0 to w1, and let X(w) be the computed position of a vertex
//! ([`deformed_position`](crate::deformed_position)); per coordinate, with u = 2^-53 and mode k:
//!
//! - **X is monotone.** The sum A of the terms before mode k is one f64 for all w. Then follow `fl(U_k w)`,
//!   `fl(A + ...)`, and sums with terms that are the same for all w. Each step is monotone, so X(w) is between X(w0) and
//!   X(w1). So every AABB that contains both ends contains the vertex at every w: swept AABBs cull exactly.
//! - **X is nearly a line.** With the exact line `l(w) = A + U_k w + C`, where C is the sum of the computed terms after
//!   mode k, X(w) = l(w) + e(w). The product adds an error of `u |U_k w|`, each sum one of u times itself; sums with 0 are
//!   exact. All of these magnitudes are at most the reach (`|p| + sum_j |U_j q_j|`, the larger one of both ends) and its
//!   rounding. So `|e(w)| <= E = u (2 + n) reach`, where n counts the weights after mode k that are not 0.
//! - **X is nearly the chord.** The chord c(w) from X(w0) to X(w1) is an affine function, as l is, so
//!   `|X(w) - c(w)| <= |e(w)| + max(|e(w0)|, |e(w1)|) <= 2 E`. The distance of two vertices along an axis differs from that
//!   of their chords by at most 4 E: the slack of [`free_until`](crate::geometry::free_until).
//!
//! A certificate that holds at w0 and at w1 holds at every w between: the weights between are on the line between the two
//! q, and |z| is convex. The separating-axis test in single precision (`detect/narrow_phase/separating_axis.rs`) grants four
//! of its error bounds at both ends. Two of them, less 20 units of 2^-24, are not used; they contain 8 `rounding_bound` of
//! positions, which is more than 4 E.

use glam::DVec3;

use crate::{MovingTriangle, ReducedModel};

/// The configurations of a model in which one weight varies, at two values of it.
pub(super) struct WeightLine {
    model: ReducedModel,
    mode: usize,
    ends: [Vec<f64>; 2],
}

impl WeightLine {
    /// Creates the line. `q`: the other weights; both ends are at q.
    pub(super) fn new(model: &ReducedModel, q: &[f64], mode: usize) -> Self {
        Self { model: model.clone(), mode, ends: [q.to_vec(), q.to_vec()] }
    }

    /// Sets the weights of both ends.
    pub(super) fn set(&mut self, weights: [f64; 2]) {
        for (q, weight) in self.ends.iter_mut().zip(weights) {
            q[self.mode] = weight;
        }
    }

    /// Returns the configurations of both ends.
    pub(super) fn ends(&self) -> [&[f64]; 2] {
        [&self.ends[0], &self.ends[1]]
    }

    /// Sets both ends to the configuration at a weight, and returns it.
    pub(super) fn at(&mut self, weight: f64) -> &[f64] {
        self.set([weight; 2]);
        &self.ends[0]
    }

    /// Returns three vertices that move from one end to the other.
    pub(super) fn moving(&self, vertices: [u32; 3]) -> MovingTriangle {
        let [t0, t1] = self.ends();
        let corners = |q: &[f64]| -> [DVec3; 3] { vertices.map(|v| self.model.position(v, q)) };
        MovingTriangle { t0: corners(t0), t1: corners(t1) }
    }

    /// Returns an upper bound of the difference, along each axis, between the distance of two vertices and that of their chords, at
    /// any weight between the ends: `4 E` of the head of this file. `reaches`: those of both ends, rounded to nearest.
    pub(super) fn slack(&self, reaches: [f64; 2]) -> f64 {
        let reach = with_mutant!(reaches[0].max(reaches[1]), SweepReachAtStart, reaches[0]);
        let after = self.ends[0][self.mode + 1..].iter().filter(|weight| **weight != 0.0).count();
        let error = (f64::EPSILON / 2.0) * (2 + after) as f64 * reach;
        // The factor covers the rounding of the reach and of partial sums, the constant the underflow of products.
        let slack = 4.0 * error * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        with_mutant!(slack, SweepExact, 0.0, SweepSlackQuartered, slack / 4.0)
    }
}

/// Returns the weight at a distance of `step` from `from` towards `to`: at least the next f64, at most `to`.
pub(super) fn forward(from: f64, step: f64, to: f64) -> f64 {
    if to > from {
        (from + step).max(from.next_up()).min(to)
    } else {
        (from - step).min(from.next_down()).max(to)
    }
}

/// Returns a weight between two others, at or before the share t of the way. It allows for three roundings of the product, and
/// for one unit in the last place of the sum.
pub(super) fn weight_before([w0, w1]: [f64; 2], t: f64) -> f64 {
    let share = with_mutant!(t * (1.0 - 4.0 * f64::EPSILON), WeightShareToNearest, t);
    let w = w0 + share * (w1 - w0);
    let [down, up] = with_mutant!([w.next_down(), w.next_up()], WeightBeforeToNearest, [w, w]);
    if w1 > w0 { down.clamp(w0, w1) } else { up.clamp(w1, w0) }
}

/// Returns the number with the fewest binary digits beyond w0, up to w1, which differs from w0.
pub(super) fn simplest_between(w0: f64, w1: f64) -> f64 {
    if (w0 < 0.0) != (w1 < 0.0) && w0 != 0.0 {
        return 0.0;
    }
    // Keeps as few digits of the end farther from 0 as stay in the interval, which does not contain w0.
    let is_outward = w1.abs() > w0.abs();
    for digits in (0..=52).rev() {
        let unit = 1_u64 << digits;
        let bits = if is_outward { w1.to_bits() } else { w0.to_bits() - 1 };
        let w = f64::from_bits(bits / unit * unit);
        if w != w0 && (w1.min(w0)..=w1.max(w0)).contains(&w) {
            return w;
        }
    }
    w1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::{Random, strips};
    use crate::{Metric, Modes, TriMesh};
    use num_bigint::BigInt;

    /// Returns an f64 times 2^1100 as an integer, exactly.
    fn exact(x: f64) -> BigInt {
        let bits = x.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as i64;
        let mantissa = (bits & ((1 << 52) - 1)) | if exponent > 0 { 1 << 52 } else { 0 };
        let magnitude = BigInt::from(mantissa) << (exponent.max(1) - 1075 + 1100) as usize;
        if x < 0.0 { -magnitude } else { magnitude }
    }

    #[test]
    fn positions_are_within_the_slack_of_their_chords_and_monotone() {
        let random = &mut Random(11);
        let mut closest = 0.0_f64;
        for case in 0..60 {
            let (model, _) = strips(random, case);
            let mode = case % model.rank();
            let mut q: Vec<f64> = (0..model.rank()).map(|_| random.signed() * 3.0).collect();
            (0..q.len()).filter(|k| (k + case) % 3 == 0).for_each(|k| q[k] = 0.0);
            let (w0, w1) = (random.signed() * 2.0, random.signed() * 2.0);
            let mut line = WeightLine::new(&model, &q, mode);
            line.set([w0, w1]);
            // The bound for one vertex and its chord is half of the slack.
            let slack = exact(line.slack(line.ends().map(|q| model.reach(q))) / 2.0);
            for v in 0..model.mesh().rest_positions().len() as u32 {
                let [x0, x1] = line.ends().map(|q| model.position(v, q));
                for i in 1..8 {
                    let w = w0 + (w1 - w0) * f64::from(i) / 8.0;
                    let x = model.position(v, WeightLine::new(&model, &q, mode).at(w));
                    for axis in 0..3 {
                        let [a, b, x] = [x0[axis], x1[axis], x[axis]];
                        assert!((a.min(b)..=a.max(b)).contains(&x));
                        // The difference is (x - a) (w1 - w0) - (b - a) (w - w0), divided by w1 - w0.
                        let whole = exact(w1) - exact(w0);
                        let off =
                            (exact(x) - exact(a)) * &whole - (exact(b) - exact(a)) * (exact(w) - exact(w0));
                        let (off, limit) = (off.magnitude().clone(), whole.magnitude() * slack.magnitude());
                        assert!(off <= limit, "case {case}: vertex {v}, weight {w}");
                        let scaled = (off * 1000_u32 / limit).try_into().unwrap_or(u32::MAX);
                        closest = closest.max(f64::from(scaled) / 1000.0);
                    }
                }
            }
        }
        // The bound is not much too large.
        assert!(closest > 0.05, "{closest}");
    }

    /// Two vertices are at 0 at rest, and their displacements are a little more than a power of two, where rounding is
    /// largest. At both ends and between them products are rounded up or down, so that the distance of the vertices
    /// differs from that of their chords by almost all of the slack.
    #[test]
    fn products_that_are_rounded_apart_need_the_slack() {
        let random = &mut Random(29);
        let mut farthest = 0.0_f64;
        for case in 0..400 {
            let mut just_above = || 1.0 + 1e-3 * random.signed().abs();
            let (u, w0, w1) = (just_above(), just_above(), just_above());
            // Some motions start near rest, where the reach is small.
            let w0 = if case % 4 == 3 { w0 * 1e-3 } else { w0 };
            // The second vertex moves in the opposite direction. A third one makes a triangle.
            let modes = [DVec3::X * u, DVec3::X * -just_above(), DVec3::ZERO].to_vec();
            let mesh = TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, 2]]).unwrap();
            let modes = Modes::new(1, modes).unwrap();
            let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
            let mut line = WeightLine::new(&model, &[0.0], 0);
            line.set([w0, w1]);
            let slack = exact(line.slack(line.ends().map(|q| model.reach(q))));
            let distance = |w: f64| {
                let [x, y] = [0, 1].map(|v| exact(model.position(v, &[w]).x));
                y - x
            };
            let (from, to) = (distance(w0), distance(w1));
            for _ in 0..40 {
                let w = w0 + (w1 - w0) * random.signed().abs();
                // The difference is (d - d0) (w1 - w0) - (d1 - d0) (w - w0), divided by w1 - w0.
                let whole = exact(w1) - exact(w0);
                let off = (distance(w) - &from) * &whole - (&to - &from) * (exact(w) - exact(w0));
                let (off, limit) = (off.magnitude().clone(), whole.magnitude() * slack.magnitude());
                assert!(off <= limit, "case {case}: weight {w}");
                let scaled: u32 = (off * 1000_u32 / limit).try_into().unwrap();
                farthest = farthest.max(f64::from(scaled) / 1000.0);
            }
        }
        assert!(farthest > 0.3, "{farthest}");
    }

    /// All roundings of a position have the same sign: those of the sums after the mode, or those of the product and of the sum.
    #[test]
    fn the_slack_covers_the_sum_of_the_mode_and_all_later_sums() {
        let power = |n: i32| 2.0_f64.powi(n);
        let unit = f64::EPSILON / 2.0;
        // It is lost in a sum from 1 to 2, and rounded up to a unit in one from 0.5 to 1.
        let lost = 0.98 * unit;
        for (later, rest, by, w0, w1, w, share) in [
            (20, 0.0, 1.0, 0.75, 1.5, 1.0, 6_u32),
            (
                0,
                lost,
                1.0 + power(-27),
                1.0 - unit * (power(37) - power(26) - 1.0),
                1.0 + 2.0 * unit * (power(36) + power(26) + 1.0),
                1.0 + 2.0 * unit * (power(26) - 1.0),
                2,
            ),
        ] {
            let rank = 1 + later;
            let of_vertex =
                |sign: f64| (0..rank).map(move |k| DVec3::X * (sign * if k == 0 { by } else { lost }));
            let modes = Modes::new(rank, [1.0, -1.0, 0.0].into_iter().flat_map(of_vertex).collect()).unwrap();
            let p = [1.0, -1.0, 0.0].map(|sign| DVec3::X * (sign * rest)).to_vec();
            let mesh = TriMesh::new(p, vec![[0, 1, 2]]).unwrap();
            let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
            let at = |w: f64| (0..rank).map(|k| if k == 0 { w } else { 1.0 }).collect::<Vec<f64>>();
            let mut line = WeightLine::new(&model, &at(0.0), 0);
            line.set([w0, w1]);
            let slack = exact(line.slack(line.ends().map(|q| model.reach(q))));
            let distance = |w: f64| {
                let [x, y] = [0, 1].map(|v| exact(model.position(v, &at(w)).x));
                y - x
            };
            let whole = exact(w1) - exact(w0);
            let off = (distance(w) - distance(w0)) * &whole
                - (distance(w1) - distance(w0)) * (exact(w) - exact(w0));
            let (off, limit) = (off.magnitude().clone(), whole.magnitude() * slack.magnitude());
            assert!(off <= limit, "{later}");
            assert!(off * share > limit, "{later}");
        }
    }

    #[test]
    fn weights_are_rounded_towards_the_start() {
        let random = &mut Random(12);
        for _ in 0..2000 {
            let [w0, w1] =
                [random.signed(), random.signed()].map(|x| x * 2.0_f64.powi((random.signed() * 30.0) as i32));
            let t = (random.signed() + 1.0) / 2.0;
            let w = weight_before([w0, w1], t);
            assert!((w0.min(w1)..=w0.max(w1)).contains(&w));
            // w - w0 <= t (w1 - w0), with both sides exact and multiplied by a further 2^1100.
            let way = exact(w) - exact(w0);
            let whole = exact(w1) - exact(w0);
            assert!((way.magnitude() << 1100_usize) <= whole.magnitude() * exact(t).magnitude());
            assert!(forward(w0, 0.0, w1) != w0 && forward(w0, f64::INFINITY, w1) == w1);
        }
        for (w0, w1, simplest) in [
            (0.999_999_99, 1.000_000_1, 1.0),
            (1.0, 0.999_999_9, 0.999_999_940_395_355_2),
            (-0.7, -0.75, -0.75),
            (0.1, 0.100_1, 0.100_097_656_25),
            (-0.1, 0.3, 0.0),
            (0.3, 0.0, 0.25),
            (0.0, 0.5, 0.5),
            (1.0, 1.0_f64.next_up(), 1.0_f64.next_up()),
        ] {
            assert_eq!(simplest_between(w0, w1), simplest, "{w0} {w1}");
        }
        assert_eq!((forward(0.0, 0.25, 1.0), forward(0.0, 0.25, -1.0)), (0.25, -0.25));
    }

    #[test]
    fn the_slack_counts_the_later_modes_that_move() {
        let (model, _) = strips(&mut Random(1), 3);
        let line = WeightLine::new(&model, &[1.0, 2.0, 0.0, 3.0], 1);
        // The product, the sum of the mode, and that of one later mode.
        let (slack, least) = (line.slack([1.0, 0.5]), 4.0 * 3.0 * (f64::EPSILON / 2.0));
        assert!(slack >= least && slack <= least * (1.0 + 1e-8), "{slack:e}");
        assert!(line.slack([0.0; 2]) > 0.0);
    }
}
