//! Exact signs of orientation determinants: on which side of a plane or a line a point lies.
//!
//! This is a filter in the sense of Shewchuk (1997): it evaluates a determinant in f64 and takes its sign only if the magnitude
//! exceeds an error bound; otherwise [`exact_orientation`] decides. The error bounds, with `u = 2^-53`, follow from three facts
//! of IEEE 754 arithmetic that rounds to nearest, without fused multiply-add:
//! - `fl(x + y) = (x + y)(1 + d)` with `|d| <= u`; a sum that underflows is exact;
//! - `fl(x y) = x y (1 + d) + h` with `|d| <= u`, and `h` is 0 unless the product underflows; `|h| <= 2^-1075`;
//! - nothing overflows: coordinates are at most 2^202 (2^200, or differences of such ones, rounded), so differences are
//!   at most 2^203 and no determinant of three of them exceeds 2^612.
//!
//! **In space** ([`Plane::side`]), `det = (q x r) . s` with three difference vectors q, r, s is a sum of
//! six signed products `q_i r_j s_k`. On its way into the sum, each goes through at most 8 roundings: three
//! differences, the inner product, the difference that completes the normal, the outer product, two
//! sums. With `T` the exact sum of the six magnitudes, and without underflow,
//! `|fl(det) - det| <= ((1 + u)^8 - 1) T`. The bound sums the computed magnitudes in the same order, hence
//! `fl(P) >= (1 - u)^8 T`. Together: error `<= ((1 + u)^8 - 1) / (1 - u)^8 fl(P) < (8 u + 100 u^2) fl(P)`.
//! The factor `9 u` is larger by `u - 100 u^2`, far more than the two roundings of `9 u P + A` take away.
//! Underflow: the six inner products err by `h`, then multiplied by at most 2^203 and up to four roundings;
//! the three outer products err by `h` alone: in all less than `7 * 2^-1075 * 2^203 < 2^-869`. The same may be
//! missing in `P`, where `9 u` makes it negligible, and `9 u P` itself errs by `h`. `A = 2^-860` covers all
//! of this many times over.
//!
//! **In the plane** ([`orient2d`]), each of the two products goes through 4 roundings (two differences, the
//! product, the last difference), so the same steps give `(4 u + 40 u^2) fl(P)`, for which `5 u` is enough.
//! Underflow adds one `h` for each product and one for `5 u P`: less than `A = 2^-1022`.

use glam::{DVec2, DVec3};

use super::exact_orientation;

/// Relative error of a determinant in space: `9 u`.
const RELATIVE_3D: f64 = 9.0 / (1_u64 << 53) as f64;

/// Absolute error of a determinant in space, from underflow: 2^-860.
const ABSOLUTE_3D: f64 = f64::from_bits((1023 - 860) << 52);

/// Relative error of a determinant in the plane: `5 u`.
const RELATIVE_2D: f64 = 5.0 / (1_u64 << 53) as f64;

/// Absolute error of a determinant in the plane, from underflow: 2^-1022.
const ABSOLUTE_2D: f64 = f64::MIN_POSITIVE;

/// The plane through three corners, with the terms of the filter that do not depend on the point.
///
/// If the corners are collinear, every point is on side 0.
pub(super) struct Plane<'a> {
    /// The corners `a, b, c`.
    corners: &'a [DVec3; 3],
    /// `(b - a) x (c - a)`, rounded.
    normal: DVec3,
    /// For each component of the normal, the sum of the magnitudes of its two products, rounded.
    magnitude: DVec3,
}

/// A determinant, rounded, and an upper bound of its rounding error.
#[derive(Clone, Copy)]
struct Estimate {
    det: f64,
    error: f64,
}

impl<'a> Plane<'a> {
    /// Returns the plane through the corners. Seen from its upper side they turn counterclockwise.
    #[inline(always)]
    pub(super) fn through(corners: &'a [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let (q, r) = (b - a, c - a);
        let (plus_x, minus_x) = (q.y * r.z, q.z * r.y);
        let (plus_y, minus_y) = (q.z * r.x, q.x * r.z);
        let (plus_z, minus_z) = (q.x * r.y, q.y * r.x);
        Self {
            corners,
            normal: DVec3::new(plus_x - minus_x, plus_y - minus_y, plus_z - minus_z),
            magnitude: DVec3::new(
                plus_x.abs() + minus_x.abs(),
                plus_y.abs() + minus_y.abs(),
                plus_z.abs() + minus_z.abs(),
            ),
        }
    }

    /// Returns 1 for a point strictly above the plane, -1 strictly below, 0 on it: the exact sign.
    #[inline(always)]
    pub(super) fn side(&self, point: DVec3) -> i8 {
        self.decide(self.estimate(&point), &point)
    }

    /// Returns [`Plane::side`] of three points. None if all are strictly on one side of the plane.
    #[inline(always)]
    pub(super) fn sides_unless_separated(&self, points: &[DVec3; 3]) -> Option<[i8; 3]> {
        let [p, q, r] = points;
        let (at_p, at_q, at_r) = (self.estimate(p), self.estimate(q), self.estimate(r));
        // Most calls end here, so all three determinants come before the first branch
        // (docs/notes/exact-tests.md#triangle-tests).
        if (at_p.det > at_p.error) & (at_q.det > at_q.error) & (at_r.det > at_r.error)
            | (at_p.det < -at_p.error) & (at_q.det < -at_q.error) & (at_r.det < -at_r.error)
        {
            return None;
        }
        let sides = [self.decide(at_p, p), self.decide(at_q, q), self.decide(at_r, r)];
        if is_strictly_one_side(&sides) { None } else { Some(sides) }
    }

    /// Returns the determinant for a point.
    #[inline(always)]
    fn estimate(&self, point: &DVec3) -> Estimate {
        let origin = &self.corners[0];
        let (x, y, z) = (point.x - origin.x, point.y - origin.y, point.z - origin.z);
        let (n, m) = (self.normal, self.magnitude);
        let det = n.x * x + n.y * y + n.z * z;
        let permanent = m.x * x.abs() + m.y * y.abs() + m.z * z.abs();
        Estimate { det, error: RELATIVE_3D * permanent + ABSOLUTE_3D }
    }

    /// Returns the side of a point, given its estimate.
    #[inline(always)]
    fn decide(&self, Estimate { det, error }: Estimate, point: &DVec3) -> i8 {
        if det > error {
            1
        } else if det < -error {
            -1
        } else {
            self.exact_side(point)
        }
    }

    /// Returns the side of a point if the filter does not decide it.
    #[cold]
    #[inline(never)]
    fn exact_side(&self, point: &DVec3) -> i8 {
        let [a, b, c] = *self.corners;
        exact_orientation::orient3d(a, b, c, *point)
    }
}

/// Returns the exact sign of `det(b - a, c - a, d - a)`: 1 if d is above the plane through a, b, c.
#[inline]
pub(super) fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    Plane::through(&[a, b, c]).side(d)
}

/// Returns the exact sign of `det(b - a, c - a)`: 1 if a, b, c turn left, -1 if they turn right, 0 if collinear.
/// Coordinates are at most [`limits::LARGEST`](crate::limits::LARGEST) in magnitude.
#[inline]
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> i8 {
    let (q, r) = (b - a, c - a);
    let (plus, minus) = (q.x * r.y, q.y * r.x);
    let det = plus - minus;
    let error = RELATIVE_2D * (plus.abs() + minus.abs()) + ABSOLUTE_2D;
    if det > error {
        1
    } else if det < -error {
        -1
    } else {
        exact_orientation::orient2d(a, b, c)
    }
}

/// Whether all sides are strictly above, or all strictly below.
#[inline]
pub(super) fn is_strictly_one_side(sides: &[i8]) -> bool {
    sides.iter().all(|s| *s > 0) || sides.iter().all(|s| *s < 0)
}

#[cfg(test)]
mod tests;
