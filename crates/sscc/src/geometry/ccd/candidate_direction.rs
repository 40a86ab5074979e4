//! Directions that provably separate two moving triangles during an interval of time.
//!
//! Candidates come from any heuristic; this file evaluates them with a rounding bound. With `u = 2^-53`: at t = 0 and
//! at t = 1 all corners are taken relative to one of them, `p - o`, which errs by `u |p - o|` in each component (a
//! common motion of both triangles, however large, does no harm). With `M` the largest magnitudes of these (over all
//! corners and both times) and `m = sum_c |n_c| M_c`, a projection `n.(p - o)` errs by at most `4 u m` (that rounding,
//! a product, two sums), the gap of two projections by `10 u m`. Interpolating it to a time t, `g0 + t (g1 - g0)`,
//! rounds three more times, magnitudes of at most `4 m`: `10 u m`. The root of a linear function is rounded three
//! times relative to itself, where the function changes by at most `4 m`: `12 u m`. A gap separates when it exceeds
//! `40 u m`, more than all of them together. Underflow: each of these few dozen operations errs by at most 2^-1074,
//! for which 2^-1022 is added. The coordinates are at most 2^200, those relative to a corner 2^201, and the largest
//! component of a direction is 1, so nothing overflows.
//!
//! A slack makes a proof hold for corners that are off these lines: the gap must then also exceed `slack sum_c |n_c|`,
//! which is at least the change of a gap of two corners whose distance along each axis is off by at most the slack.

use glam::DVec3;

use super::moving_triangle::MovingTriangle;
use crate::geometry::TwoTriangles;

/// Gaps along n separate when they exceed this many times `sum_c |n_c| M_c` plus [`ABSOLUTE`].
const RELATIVE: f64 = 40.0 * (f64::EPSILON / 2.0);

/// The term of this limit that covers underflow: 2^-1022.
const ABSOLUTE: f64 = f64::MIN_POSITIVE;

/// Two moving triangles a and b, relative to the first corner of a, which moves linearly like all others.
pub(super) struct MovingPair {
    a: MovingTriangle,
    b: MovingTriangle,
    /// For each axis the largest magnitude of a corner.
    reach: DVec3,
    /// An upper bound, along each axis, of the amount by which the distance of two corners differs from that of corners
    /// that move linearly.
    slack: f64,
}

/// A candidate direction with the corners of both triangles projected on it, at t = 0 and at t = 1.
#[derive(Clone, Copy)]
pub(super) struct CandidateDirection {
    a: [[f64; 3]; 2],
    b: [[f64; 3]; 2],
    /// The rounding bound and the change by the slack: gaps separate when they exceed this sum.
    rounding: f64,
}

impl MovingPair {
    #[inline]
    pub(super) fn new(a: &MovingTriangle, b: &MovingTriangle) -> Self {
        Self::with_slack(a, b, 0.0)
    }

    #[inline]
    pub(super) fn with_slack(a: &MovingTriangle, b: &MovingTriangle, slack: f64) -> Self {
        let relative = |triangle: &MovingTriangle| MovingTriangle {
            t0: triangle.t0.map(|p| p - a.t0[0]),
            t1: triangle.t1.map(|p| p - a.t1[0]),
        };
        let (a, b) = (relative(a), relative(b));
        let corners = a.t0.iter().chain(&a.t1).chain(&b.t0).chain(&b.t1);
        let reach = corners.fold(DVec3::ZERO, |reach, p| reach.max(p.abs()));
        Self { a, b, reach, slack }
    }

    /// Returns the largest magnitude of a coordinate of a corner relative to the first corner of a: the unit of
    /// tolerances.
    #[inline]
    pub(super) fn size(&self) -> f64 {
        self.reach.max_element()
    }

    /// Returns the upper bound, along each axis, of the amount by which the distance of two corners may differ from the
    /// given one.
    pub(super) fn slack(&self) -> f64 {
        self.slack
    }

    /// Returns the corners of both triangles at a time, rounded. Only heuristics use them.
    #[inline]
    pub(super) fn at(&self, t: f64) -> TwoTriangles {
        TwoTriangles { a: self.a.at(t), b: self.b.at(t) }
    }

    /// Projects the corners on a direction. None for 0 and vectors that are not finite.
    #[inline]
    pub(super) fn along(&self, dir: DVec3) -> Option<CandidateDirection> {
        let dir = dir / dir.abs().max_element();
        if !dir.is_finite() {
            return None;
        }
        let project = |triangle: &MovingTriangle| [triangle.t0, triangle.t1].map(|p| p.map(|p| dir.dot(p)));
        Some(CandidateDirection { a: project(&self.a), b: project(&self.b), rounding: self.rounding(dir) })
    }

    /// Returns the sum of the rounding bound of gaps along a direction and of their change by the slack.
    #[inline]
    pub(super) fn rounding(&self, dir: DVec3) -> f64 {
        let slack = self.slack * dir.abs().element_sum();
        with_mutant!(RELATIVE * dir.abs().dot(self.reach) + ABSOLUTE, SeparationExact, 0.0)
            + with_mutant!(slack, CandidateSlackQuartered, slack / 4.0)
    }
}

impl CandidateDirection {
    /// Returns the opposite direction.
    #[inline]
    pub(super) fn reversed(&self) -> Self {
        let negate = |times: [[f64; 3]; 2]| times.map(|p| p.map(|p| -p));
        Self { a: negate(self.a), b: negate(self.b), rounding: self.rounding }
    }

    /// Returns a lower bound of the gap along this direction at a time, with a below b. If it is positive, they are
    /// disjoint.
    #[inline]
    pub(super) fn gap(&self, t: f64) -> f64 {
        smallest(interpolate(&self.b, t)) - largest(interpolate(&self.a, t)) - self.rounding
    }

    /// Whether a stays below b along this direction from t = 0 to 1.
    #[inline]
    pub(super) fn separates(&self) -> bool {
        (with_mutant!(0, PlanesAtEnd, 1)..2)
            .all(|time| smallest(self.b[time]) - largest(self.a[time]) > self.rounding)
    }

    /// Returns the time until which a stays below b along this direction, from `t` on. Infinite if it does until t = 1; `t` if a
    /// is not below b at `t`.
    #[inline]
    pub(super) fn separates_until(&self, t: f64) -> f64 {
        let mut until = f64::INFINITY;
        for i in 0..3 {
            for j in 0..3 {
                let [g0, g1] = [0, 1].map(|time| self.b[time][j] - self.a[time][i] - self.rounding);
                // NaN does not separate.
                let is_separated_at_t = g0 + t * (g1 - g0) > 0.0;
                if !is_separated_at_t {
                    return t;
                }
                let is_separated_at_t1 = with_mutant!(g1 > 0.0, SeparatedForever, true);
                if !is_separated_at_t1 {
                    until = until.min(g0 / (g0 - g1));
                }
            }
        }
        until.max(t)
    }

    /// Whether a stays below b from `t` to `s` along the direction that turns linearly from this one to the other:
    /// along `(1 - w) n + w m` at the time `(1 - w) t + w s`. The gap of two corners is a quadratic polynomial of w
    /// whose Bernstein coefficients are the gap along n at t, the mean of those along n at s and along m at t, and that
    /// along m at s.
    #[inline]
    pub(super) fn separates_turning(&self, t: f64, to: &Self, s: f64) -> bool {
        let sum = |p: [f64; 3], q: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| p[i] + q[i]) };
        let gap = |a: [f64; 3], b: [f64; 3]| smallest(b) - largest(a);
        self.gap(t) > 0.0 && to.gap(s) > 0.0 && {
            let a = sum(interpolate(&self.a, s), interpolate(&to.a, t));
            let b = sum(interpolate(&self.b, s), interpolate(&to.b, t));
            with_mutant!(gap(a, b) > self.rounding + to.rounding, TurningByEnds, true)
        }
    }
}

/// Interpolates linearly between the values at t = 0 and at t = 1.
#[inline]
fn interpolate(times: &[[f64; 3]; 2], t: f64) -> [f64; 3] {
    std::array::from_fn(|i| times[0][i] + t * (times[1][i] - times[0][i]))
}

#[inline]
fn smallest([p, q, r]: [f64; 3]) -> f64 {
    p.min(q).min(r)
}

#[inline]
fn largest([p, q, r]: [f64; 3]) -> f64 {
    p.max(q).max(r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Returns two triangles whose corners move between integers, the second one shifted along a direction.
    fn on_grid(random: &mut Random, dir: DVec3) -> [MovingTriangle; 2] {
        let mut corners = |by: DVec3| [(); 3].map(|()| (random.vector() * 3.0).round() + by);
        let a = MovingTriangle { t0: corners(DVec3::ZERO), t1: corners(DVec3::ZERO) };
        let b = MovingTriangle { t0: corners(dir), t1: corners(dir) };
        [a, b]
    }

    /// Returns a vector of integers, the largest of which is 4.
    fn direction(random: &mut Random) -> DVec3 {
        let mut dir = (random.vector() * 4.0).round();
        dir[random.below(3)] = if random.below(2) == 0 { 4.0 } else { -4.0 };
        dir
    }

    /// Returns the gaps of all nine pairs of corners along a direction at a time.
    fn gaps([a, b]: [&MovingTriangle; 2], n: DVec3, t: f64) -> [f64; 9] {
        let at = |triangle: &MovingTriangle, i: usize| {
            n.dot(triangle.t0[i] + (triangle.t1[i] - triangle.t0[i]) * t)
        };
        std::array::from_fn(|ij| at(b, ij % 3) - at(a, ij / 3))
    }

    /// Of integers, and at quarters, all numbers but the rounding bound are exact. The length of a direction does not
    /// matter.
    #[test]
    fn gaps_are_those_of_all_corners_less_the_slack() {
        let random = &mut Random(5);
        // Gaps of differing signs at both ends, and roots.
        let (mut always, mut open, mut roots) = (0, 0, 0);
        for case in 0..1_200 {
            let dir = direction(random);
            let [a, b] = on_grid(random, dir);
            let slack = [0.0, 0.25, 1.0][case % 3];
            let pair = MovingPair::with_slack(&a, &b, slack);
            assert_eq!(pair.slack(), slack);
            let n = dir / 4.0;
            let change = slack * n.abs().element_sum();
            let along = pair.along(dir * [1.0, 2.0_f64.powi(100), 2.0_f64.powi(-300)][case / 3 % 3]).unwrap();
            let proven = |n: DVec3, t: f64| gaps([&a, &b], n, t).map(|gap| gap - change);
            let narrowest = |n: DVec3, t: f64| proven(n, t).into_iter().fold(f64::INFINITY, f64::min);
            for (along, n) in [(along, n), (along.reversed(), -n)] {
                for t in [0.0, 0.25, 0.5, 1.0] {
                    let (found, exact) = (along.gap(t), narrowest(n, t));
                    assert!(found <= exact && found >= exact - 1e-12, "case {case} at {t}: {found} {exact}");
                    let until = along.separates_until(t);
                    if exact <= 0.0 {
                        assert_eq!(until, t, "case {case}");
                        continue;
                    }
                    let ends = proven(n, 0.0).into_iter().zip(proven(n, 1.0)).filter(|(_, g1)| *g1 <= 0.0);
                    let root = ends.map(|(g0, g1)| g0 / (g0 - g1)).fold(f64::INFINITY, f64::min);
                    let is_near = root == f64::INFINITY || until >= root - 1e-10;
                    assert!(until <= root && is_near, "case {case} at {t}: {until} {root}");
                    roots += usize::from(root < f64::INFINITY);
                }
                let separates = narrowest(n, 0.0) > 0.0 && narrowest(n, 1.0) > 0.0;
                assert_eq!(along.separates(), separates, "case {case}");
                always += usize::from(separates);
                open += usize::from(!separates && narrowest(n, 0.0).max(narrowest(n, 1.0)) > 0.0);
            }
        }
        assert!(always > 300 && open > 200 && roots > 300, "{always} {open} {roots}");
    }

    /// All three Bernstein coefficients of the gaps count: at either end, and between.
    #[test]
    fn turning_directions_separate_where_three_gaps_are_positive() {
        let random = &mut Random(6);
        let mut counts = [0; 8];
        for case in 0..2_000 {
            let dirs = [direction(random), direction(random)];
            let [a, b] = on_grid(random, (dirs[0] + dirs[1]) * 0.5);
            let slack = [0.0, 0.25][case % 2];
            let (t, s) = [(0.0, 1.0), (0.25, 0.5), (0.5, 1.0)][case % 3];
            let pair = MovingPair::with_slack(&a, &b, slack);
            let [from, to] = dirs.map(|dir| pair.along(dir).unwrap());
            let [n, m] = dirs.map(|dir| dir / 4.0);
            let [change_n, change_m] = [n, m].map(|n| slack * n.abs().element_sum());
            let all = |n: DVec3, t: f64| gaps([&a, &b], n, t);
            let between = [all(n, s), all(m, t)];
            let is_wide = [
                all(n, t).iter().all(|gap| *gap > change_n),
                (0..9).all(|ij| between[0][ij] + between[1][ij] > change_n + change_m),
                all(m, s).iter().all(|gap| *gap > change_m),
            ];
            let separates = is_wide.iter().all(|wide| *wide);
            assert_eq!(from.separates_turning(t, &to, s), separates, "case {case}: {is_wide:?}");
            counts[(0..3).map(|i| usize::from(is_wide[i]) << i).sum::<usize>()] += 1;
        }
        // All are wide, or all but one.
        assert!([3, 5, 6, 7].iter().all(|i| counts[*i] > 10), "{counts:?}");
    }

    /// A point passes through another one, or close by it. The direction to it separates the two at both ends of the
    /// motion.
    #[test]
    fn turning_directions_are_tested_between_both_ends() {
        let rests = MovingTriangle::vertex(DVec3::ZERO, DVec3::ZERO);
        for (from, to, separates) in [
            (DVec3::X, DVec3::NEG_X, false),
            (DVec3::X, DVec3::new(-1.0, 0.1, 0.0), false),
            (DVec3::new(1.0, 0.5, 0.0), DVec3::new(0.5, 1.0, 0.0), true),
        ] {
            let pair = MovingPair::new(&rests, &MovingTriangle::vertex(from, to));
            let [start, end] = [from, to].map(|dir| pair.along(dir).unwrap());
            assert!(start.gap(0.0) > 0.0 && end.gap(1.0) > 0.0);
            assert_eq!(start.separates_turning(0.0, &end, 1.0), separates, "{from} {to}");
        }
    }
}
