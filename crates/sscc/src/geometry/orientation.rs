//! On which side: exact signs of the orientation determinants, by a floating-point filter first.
//!
//! The filter evaluates a determinant in plain `f64` and believes its sign only beyond a bound on the
//! error; otherwise [`exact`] decides. The bounds, with `u = 2^-53`, rest on three facts of IEEE 754
//! arithmetic that rounds to nearest, without fused multiply-add:
//! - `fl(x + y) = (x + y)(1 + d)` with `|d| <= u`; a sum that underflows is exact;
//! - `fl(x y) = x y (1 + d) + h` with `|d| <= u`, and `h` is 0 unless the product underflows; `|h| <= 2^-1075`;
//! - nothing overflows: coordinates are at most 2^200, so differences are at most 2^201 and no
//!   determinant of three of them exceeds 2^606.
//!
//! **In space** ([`Plane::side`]), `det = (q x r) . s` with three difference vectors q, r, s is a sum of
//! six signed products `q_i r_j s_k`. On its way into the sum, each goes through at most 8 roundings: three
//! differences, the inner product, the difference that completes the normal, the outer product, two
//! sums. With `T` the exact sum of the six magnitudes, and without underflow,
//! `|fl(det) - det| <= ((1 + u)^8 - 1) T`. The bound sums the computed magnitudes in the same order, hence
//! `fl(P) >= (1 - u)^8 T`. Together: error `<= ((1 + u)^8 - 1) / (1 - u)^8 fl(P) < (8 u + 100 u^2) fl(P)`.
//! The factor `9 u` is larger by `u - 100 u^2`, far more than the two roundings of `9 u P + A` take away.
//! Underflow: the six inner products err by `h`, then multiplied by at most 2^201 and up to four roundings;
//! the three outer products err by `h` alone: in all less than `7 * 2^-1075 * 2^201 < 2^-871`. The same may be
//! missing in `P`, where `9 u` makes it negligible, and `9 u P` itself errs by `h`. `A = 2^-860` covers all
//! of this many times over.
//!
//! **In the plane** ([`orient2d`]), each of the two products goes through 4 roundings (two differences, the
//! product, the last difference), so the same steps give `(4 u + 40 u^2) fl(P)`, for which `5 u` is enough.
//! Underflow adds one `h` for each product and one for `5 u P`: less than `A = 2^-1022`.

use glam::{DVec2, DVec3};

use super::exact;

/// Relative error of a determinant in space: `9 u`.
const RELATIVE_3D: f64 = 9.0 / (1_u64 << 53) as f64;

/// Absolute error of a determinant in space, from underflow: 2^-860.
const ABSOLUTE_3D: f64 = f64::from_bits((1023 - 860) << 52);

/// Relative error of a determinant in the plane: `5 u`.
const RELATIVE_2D: f64 = 5.0 / (1_u64 << 53) as f64;

/// Absolute error of a determinant in the plane, from underflow: 2^-1022.
const ABSOLUTE_2D: f64 = f64::MIN_POSITIVE;

/// The plane through three corners, with what the filter needs again and again for many points.
///
/// If the corners are collinear there is no plane, and every point is on side 0.
pub(super) struct Plane<'a> {
    /// The corners `a, b, c`.
    corners: &'a [DVec3; 3],
    /// `(b - a) x (c - a)`, rounded.
    normal: DVec3,
    /// For each component of the normal, the sum of the magnitudes of its two products, rounded.
    magnitude: DVec3,
}

impl<'a> Plane<'a> {
    /// The plane through the corners; its upper side sees them counterclockwise.
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

    /// 1 for a point strictly above the plane, -1 strictly below, 0 on it: the exact sign.
    #[inline(always)]
    pub(super) fn side(&self, point: DVec3) -> i8 {
        let (det, bound) = self.estimate(&point);
        self.decide(det, bound, &point)
    }

    /// [`Plane::side`] of three points; [`None`] if all are strictly on one side.
    #[inline(always)]
    pub(super) fn sides_unless_apart(&self, points: &[DVec3; 3]) -> Option<[i8; 3]> {
        let [p, q, r] = points;
        let ((p_det, p_bound), (q_det, q_bound), (r_det, r_bound)) =
            (self.estimate(p), self.estimate(q), self.estimate(r));
        // Most calls end here, so all three are computed before the first branch; point by point it took
        // twice as long.
        if (p_det > p_bound) & (q_det > q_bound) & (r_det > r_bound)
            | (p_det < -p_bound) & (q_det < -q_bound) & (r_det < -r_bound)
        {
            return None;
        }
        let sides =
            [self.decide(p_det, p_bound, p), self.decide(q_det, q_bound, q), self.decide(r_det, r_bound, r)];
        if strictly_one_side(&sides) { None } else { Some(sides) }
    }

    /// The determinant for a point, rounded, and a bound on its error.
    #[inline(always)]
    fn estimate(&self, point: &DVec3) -> (f64, f64) {
        let origin = &self.corners[0];
        let (x, y, z) = (point.x - origin.x, point.y - origin.y, point.z - origin.z);
        let (n, m) = (self.normal, self.magnitude);
        let det = n.x * x + n.y * y + n.z * z;
        let permanent = m.x * x.abs() + m.y * y.abs() + m.z * z.abs();
        (det, RELATIVE_3D * permanent + ABSOLUTE_3D)
    }

    /// The side of a point, given its estimate.
    #[inline(always)]
    fn decide(&self, det: f64, bound: f64, point: &DVec3) -> i8 {
        if det > bound {
            1
        } else if det < -bound {
            -1
        } else {
            self.exact_side(point)
        }
    }

    /// The side of a point that the filter cannot tell.
    #[cold]
    #[inline(never)]
    fn exact_side(&self, point: &DVec3) -> i8 {
        let [a, b, c] = *self.corners;
        exact::orient3d(a, b, c, *point)
    }
}

/// The exact sign of `det(b - a, c - a, d - a)`: 1 if d is above the plane through a, b, c.
#[inline]
pub(super) fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    Plane::through(&[a, b, c]).side(d)
}

/// The exact sign of `det(b - a, c - a)`: 1 if a, b, c turn left, -1 if they turn right, 0 if collinear.
#[inline]
pub(super) fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> i8 {
    let (q, r) = (b - a, c - a);
    let (plus, minus) = (q.x * r.y, q.y * r.x);
    let det = plus - minus;
    let bound = RELATIVE_2D * (plus.abs() + minus.abs()) + ABSOLUTE_2D;
    if det > bound {
        1
    } else if det < -bound {
        -1
    } else {
        exact::orient2d(a, b, c)
    }
}

/// Whether all are strictly above, or all strictly below.
#[inline]
pub(super) fn strictly_one_side(sides: &[i8]) -> bool {
    sides.iter().all(|s| *s > 0) || sides.iter().all(|s| *s < 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{Signed, ToPrimitive};

    /// `x` in exact arithmetic.
    fn rational(x: f64) -> BigRational {
        BigRational::from_float(x).unwrap()
    }

    /// The sign of the 3 x 3 determinant of differences, in exact arithmetic, by its six products.
    fn naive_3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
        let m = [b, c, d].map(|p| [0, 1, 2].map(|k| rational(p[k]) - rational(a[k])));
        let product = |i: usize, j: usize, k: usize| &m[0][i] * &m[1][j] * &m[2][k];
        let plus = product(0, 1, 2) + product(1, 2, 0) + product(2, 0, 1);
        let minus = product(2, 1, 0) + product(1, 0, 2) + product(0, 2, 1);
        (plus - minus).signum().to_i8().unwrap()
    }

    /// The sign of the 2 x 2 determinant of differences, in exact arithmetic.
    fn naive_2d(a: DVec2, b: DVec2, c: DVec2) -> i8 {
        let m = [b, c].map(|p| [0, 1].map(|k| rational(p[k]) - rational(a[k])));
        (&m[0][0] * &m[1][1] - &m[0][1] * &m[1][0]).signum().to_i8().unwrap()
    }

    /// Numbers in `-1..1`, the same in every run.
    fn random() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// From all numbers that matter: denormal, where `robust` fails, where the filter fails, plain, largest.
    const SCALES: [f64; 8] = [1e-322, 1e-300, 1e-110, 1e-87, 1e-72, 1e-3, 1.0, crate::limits::LARGEST];

    #[test]
    fn convention() {
        assert_eq!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z), 1);
        assert_eq!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Z), -1);
        assert_eq!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(5.0, 7.0, 0.0)), 0);
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::Y), 1);
        assert_eq!(orient2d(DVec2::ZERO, DVec2::Y, DVec2::X), -1);
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::NEG_X), 0);
    }

    /// Points nearly on the plane (the line) through the others: closer than the filter can see.
    #[test]
    fn signs_are_exact() {
        let mut random = random();
        let mut counts = [0; 3];
        for i in 0..4_000 {
            let scale = SCALES[i % SCALES.len()];
            let mut point = || DVec3::new(random(), random(), random()) * scale;
            let (a, b, c) = (point(), point(), point());
            let (s, t) = (random(), random());
            let mut d = a + ((b - a) * s + (c - a) * t) / 4.0;
            if i % 3 == 0 {
                d.x = d.x.next_up();
            }
            let d = d.clamp(DVec3::splat(-scale), DVec3::splat(scale));
            let sign = orient3d(a, b, c, d);
            assert_eq!(sign, naive_3d(a, b, c, d), "{a:?} {b:?} {c:?} {d:?}");
            counts[(sign + 1) as usize] += 1;

            let (a, b) = (a.truncate(), b.truncate());
            let c = a + (b - a) * (s / 4.0);
            assert_eq!(orient2d(a, b, c), naive_2d(a, b, c), "{a:?} {b:?} {c:?}");
        }
        assert!(counts[0] > 500 && counts[2] > 500, "one-sided: {counts:?}");
    }

    /// In exact arithmetic the first product is the smaller one. Rounded, its difference of coordinates goes up
    /// and those of the second go down, to the two sides of half the smallest denormal number.
    #[test]
    fn underflow_does_not_deceive_the_planar_filter() {
        let power = |exponent: i32| f64::from_bits(((1023 + exponent) as u64) << 52);
        let a = DVec2::new(-(power(-591) + power(-598)), -(power(-591) - power(-598)));
        let b = DVec2::splat(power(-538));
        let c = DVec2::new(power(-537), power(-537).next_down());
        assert!((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0);
        assert_eq!(orient2d(a, b, c), -1);
        assert_eq!(naive_2d(a, b, c), -1);
    }

    /// Cancellation of very different numbers, with zeros.
    #[test]
    fn signs_are_exact_for_mixed_magnitudes() {
        let mut random = random();
        for _ in 0..1_500 {
            let mut coordinate = || {
                let exponent = (random() * 637.0 - 437.0) as i32;
                // -1074 to 200; the smallest in two steps, as 2^-1074 is no normal number.
                let half = 2.0_f64.powi(exponent / 2);
                if random() < -0.5 { 0.0 } else { random() * half * 2.0_f64.powi(exponent - exponent / 2) }
            };
            let mut point = || DVec3::new(coordinate(), coordinate(), coordinate());
            let (a, b, c, d) = (point(), point(), point(), point());
            assert_eq!(orient3d(a, b, c, d), naive_3d(a, b, c, d), "{a:?} {b:?} {c:?} {d:?}");
            let [a, b, c] = [a, b, c].map(DVec3::truncate);
            assert_eq!(orient2d(a, b, c), naive_2d(a, b, c), "{a:?} {b:?} {c:?}");
        }
    }
}
