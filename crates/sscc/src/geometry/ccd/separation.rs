//! Directions that provably separate two moving triangles during an interval of time.
//!
//! Directions come from any heuristic; whether they separate is evaluated with all rounding accounted for. With
//! `u = 2^-53`: at each end all corners are taken relative to one of them, `p - o`, which errs by `u |p - o|` in each
//! component (a common motion of both triangles, however large, does no harm); with `M` the largest magnitudes of these
//! (over all corners and both ends) and `m = sum_c |n_c| M_c`, a projection `n.(p - o)` errs by at most `4 u m` (that
//! rounding, a product, two sums), the gap of two projections by `10 u m`. Interpolating it to a time t, `g0 + t (g1 -
//! g0)`, rounds three more times, magnitudes of at most `4 m`: `10 u m`. The root of a linear function is rounded three
//! times relative to itself, where the function changes by at most `4 m`: `12 u m`. A gap counts when it exceeds `40 u
//! m`, more than all of them together. Underflow: each of these few dozen operations errs by at most 2^-1074, for which
//! 2^-1022 is added. The coordinates are at most 2^200 and the largest component of a direction is 1, so nothing
//! overflows.

use glam::DVec3;

use super::moving_triangle::MovingTriangle;

/// Gaps along n count when they exceed this many times `sum_c |n_c| M_c`.
const RELATIVE: f64 = 40.0 * (f64::EPSILON / 2.0);

/// ... and this, for underflow: 2^-1022.
const ABSOLUTE: f64 = f64::MIN_POSITIVE;

/// Two moving triangles, relative to the first corner of the first, which moves linearly like all others.
pub(super) struct Separation {
    x: MovingTriangle,
    y: MovingTriangle,
    /// For each axis the largest magnitude of a corner.
    reach: DVec3,
}

/// A direction with the corners of both triangles projected on it, at both ends of the motion.
#[derive(Clone, Copy)]
pub(super) struct Direction {
    x: [[f64; 3]; 2],
    y: [[f64; 3]; 2],
    /// Gaps count beyond this.
    error: f64,
}

impl Separation {
    #[inline]
    pub(super) fn new(x: &MovingTriangle, y: &MovingTriangle) -> Self {
        let relative = |triangle: &MovingTriangle| MovingTriangle {
            t0: triangle.t0.map(|p| p - x.t0[0]),
            t1: triangle.t1.map(|p| p - x.t1[0]),
        };
        let (x, y) = (relative(x), relative(y));
        let corners = x.t0.iter().chain(&x.t1).chain(&y.t0).chain(&y.t1);
        let reach = corners.fold(DVec3::ZERO, |reach, p| reach.max(p.abs()));
        Self { x, y, reach }
    }

    /// The largest coordinate of a corner relative to that one: the unit of tolerances.
    #[inline]
    pub(super) fn size(&self) -> f64 {
        self.reach.max_element()
    }

    /// The corners of both at a time, rounded: for heuristics.
    #[inline]
    pub(super) fn at(&self, t: f64) -> ([DVec3; 3], [DVec3; 3]) {
        (self.x.at(t), self.y.at(t))
    }

    /// Projects on n. None for a vector without a direction.
    #[inline]
    pub(super) fn along(&self, n: DVec3) -> Option<Direction> {
        let n = n / n.abs().max_element();
        if !n.is_finite() {
            return None;
        }
        let project = |triangle: &MovingTriangle| [triangle.t0, triangle.t1].map(|p| p.map(|p| n.dot(p)));
        Some(Direction { x: project(&self.x), y: project(&self.y), error: self.error(n) })
    }

    /// What gaps along a vector count beyond.
    #[inline]
    pub(super) fn error(&self, n: DVec3) -> f64 {
        right_or!(RELATIVE * n.abs().dot(self.reach) + ABSOLUTE, SeparationExact, 0.0)
    }
}

impl Direction {
    /// The same direction the other way round.
    #[inline]
    pub(super) fn reversed(&self) -> Self {
        let minus = |ends: [[f64; 3]; 2]| ends.map(|p| p.map(|p| -p));
        Self { x: minus(self.x), y: minus(self.y), error: self.error }
    }

    /// How far x is below y along this direction at a time, beyond rounding: if positive, they are apart.
    #[inline]
    pub(super) fn gap(&self, t: f64) -> f64 {
        least(between(&self.y, t)) - greatest(between(&self.x, t)) - self.error
    }

    /// Whether x stays below y along this direction all the time.
    #[inline]
    pub(super) fn separates(&self) -> bool {
        (0..2).all(|end| least(self.y[end]) - greatest(self.x[end]) > self.error)
    }

    /// The time until which x stays below y along this direction, from `t` on: infinite when to the end, `t` when not
    /// even then.
    #[inline]
    pub(super) fn separates_until(&self, t: f64) -> f64 {
        let mut until = f64::INFINITY;
        for i in 0..3 {
            for j in 0..3 {
                let [g0, g1] = [0, 1].map(|end| self.y[end][j] - self.x[end][i] - self.error);
                // NaN does not separate.
                let apart_now = g0 + t * (g1 - g0) > 0.0;
                if !apart_now {
                    return t;
                }
                let apart_at_end = g1 > 0.0;
                if !apart_at_end {
                    until = until.min(g0 / (g0 - g1));
                }
            }
        }
        until.max(t)
    }

    /// Whether x stays below y from `t` to `s` along the direction that turns linearly from this one to the other:
    /// along `(1 - w) n + w m` at the time `(1 - w) t + w s`. The gap of two corners is a quadratic polynomial of w
    /// whose Bernstein coefficients are the gap along n at t, the mean of those along n at s and along m at t, and that
    /// along m at s.
    #[inline]
    pub(super) fn separates_turning(&self, t: f64, to: &Self, s: f64) -> bool {
        let both = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| a[i] + b[i]) };
        let gap = |x: [f64; 3], y: [f64; 3]| least(y) - greatest(x);
        self.gap(t) > 0.0
            && to.gap(s) > 0.0
            && gap(both(between(&self.x, s), between(&to.x, t)), both(between(&self.y, s), between(&to.y, t)))
                > self.error + to.error
    }
}

/// Between the values at both ends.
#[inline]
fn between(ends: &[[f64; 3]; 2], t: f64) -> [f64; 3] {
    std::array::from_fn(|i| ends[0][i] + t * (ends[1][i] - ends[0][i]))
}

#[inline]
fn least([a, b, c]: [f64; 3]) -> f64 {
    a.min(b).min(c)
}

#[inline]
fn greatest([a, b, c]: [f64; 3]) -> f64 {
    a.max(b).max(c)
}
