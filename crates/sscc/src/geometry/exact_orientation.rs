//! Computes exact signs of orientation determinants if the floating-point filter does not decide: by the adaptive expansions of
//! Shewchuk (1997, *Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates*; the crate `robust`), or
//! by integers where these would underflow.

use glam::{DVec2, DVec3};
use num_bigint::{BigInt, Sign};
use robust::{Coord, Coord3D};

use super::binary64::Binary64;

/// Smallest magnitude, other than 0, of a coordinate for which the crate `robust` is exact: 2^-240.
///
/// `robust` is exact as long as nothing underflows. A coordinate that is 0 or of at least this size is a
/// multiple of `g = 2^-292`. So are differences of coordinates, the roundoff of such differences, and the
/// halves into which `robust` splits a number before a product. Hence all products of three such numbers,
/// with their roundoff, are multiples of `g^3 = 2^-876`, and no operation on them underflows. Its error
/// bounds multiply sums of such products by no less than 2^-104 (those of the last stage, second order
/// in the rounding unit), which gives 0 or at least 2^-980: normal numbers as well.
const ROBUST_MIN: f64 = f64::from_bits((1023 - 240) << 52);

/// Returns the exact sign of `det(b - a, c - a, d - a)`.
#[cold]
#[inline(never)]
pub(super) fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    // Meshes with split vertices have many triangles that meet at equal positions.
    if d == a || d == b || d == c || a == b || a == c || b == c {
        return 0;
    }
    if [a, b, c, d].iter().flat_map(DVec3::as_ref).all(|x| is_robust_exact(*x)) {
        let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
        // `robust` has the opposite sign convention: positive if the last point is below the plane.
        return -sign(robust::orient3d(coord(a), coord(b), coord(c), coord(d)));
    }
    orient3d_integer(a, b, c, d)
}

/// Returns the exact sign of `det(b - a, c - a)`.
#[cold]
#[inline(never)]
pub(super) fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> i8 {
    if a == b || a == c || b == c {
        return 0;
    }
    if [a, b, c].iter().flat_map(DVec2::as_ref).all(|x| is_robust_exact(*x)) {
        let coord = |p: DVec2| Coord { x: p.x, y: p.y };
        return sign(robust::orient2d(coord(a), coord(b), coord(c)));
    }
    orient2d_integer(a, b, c)
}

/// Computes [`orient3d`] in integers: exact for all finite coordinates, but allocates.
fn orient3d_integer(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    let [a, b, c, d] = integers([a, b, c, d].map(|p| p.to_array()));
    let [q, r, s] = [b, c, d].map(|p| [&p[0] - &a[0], &p[1] - &a[1], &p[2] - &a[2]]);
    let minor = |i: usize, j: usize| &q[i] * &r[j] - &q[j] * &r[i];
    integer_sign(&(minor(1, 2) * &s[0] + minor(2, 0) * &s[1] + minor(0, 1) * &s[2]))
}

/// Computes [`orient2d`] in integers: exact for all finite coordinates, but allocates.
fn orient2d_integer(a: DVec2, b: DVec2, c: DVec2) -> i8 {
    let [a, b, c] = integers([a, b, c].map(|p| p.to_array()));
    let [q, r] = [b, c].map(|p| [&p[0] - &a[0], &p[1] - &a[1]]);
    integer_sign(&(&q[0] * &r[1] - &q[1] * &r[0]))
}

/// Whether `robust` is exact for determinants with this coordinate; see [`ROBUST_MIN`].
pub(super) fn is_robust_exact(x: f64) -> bool {
    x == 0.0 || x.abs() >= ROBUST_MIN
}

/// Returns the points multiplied by one power of two (which changes no sign) that makes all coordinates integers.
pub(super) fn integers<const DIM: usize, const COUNT: usize>(
    points: [[f64; DIM]; COUNT],
) -> [[BigInt; DIM]; COUNT] {
    let numbers = points.map(|p| p.map(Binary64::of));
    // Zeros have the smallest exponent of all, but need no longer integers.
    let nonzero = numbers.iter().flatten().filter(|x| x.mantissa != 0);
    let smallest = nonzero.map(|x| x.exponent).min().unwrap_or(0);
    numbers.map(|p| p.map(|x| BigInt::from(x.mantissa) << x.exponent.saturating_sub(smallest)))
}

/// Returns -1, 0 or 1; 0 for NaN, which valid input never gives.
fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// Returns -1, 0 or 1.
fn integer_sign(x: &BigInt) -> i8 {
    match x.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At the smallest numbers for which `robust` is used, both exact methods agree; far below, `robust` loses the sign.
    #[test]
    fn robust_agrees_with_integers_where_it_is_used() {
        let corners = |g: f64| {
            let (a, b, c) = (DVec3::new(1.0, 3.0, 5.0), DVec3::new(7.0, 2.0, 4.0), DVec3::new(6.0, 9.0, 8.0));
            // The point d is on the plane up to one unit in the last place of one coordinate.
            let mut d = (a * 2.0 + b + c) / 4.0;
            d.z = d.z.next_up();
            [a, b, c, d].map(|p| p * g)
        };
        // Equal points need no arithmetic.
        let [a, b, c, d] = corners(1.0);
        for [a, b, c, d] in
            [[a, b, c, a], [a, b, c, b], [a, b, c, c], [a, a, c, d], [a, b, a, d], [a, b, b, d]]
        {
            assert_eq!((orient3d(a, b, c, d), orient3d_integer(a, b, c, d)), (0, 0));
        }
        for (g, used) in [(1.0, true), (ROBUST_MIN, true), (ROBUST_MIN / 8.0, false), (1e-110, false)] {
            let points = corners(g);
            let [a, b, c, d] = points;
            assert_eq!(points.iter().flat_map(DVec3::as_ref).all(|x| is_robust_exact(*x)), used);
            assert_eq!(orient3d(a, b, c, d), orient3d_integer(a, b, c, d));
            assert_eq!(orient3d(a, b, c, d), -orient3d(b, a, c, d));
            let [a, b, c] = [a, b, d].map(DVec3::truncate);
            assert_eq!(orient2d(a, b, c), orient2d_integer(a, b, c));
        }
        let [a, b, c, d] = corners(1e-110);
        let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
        assert_eq!(robust::orient3d(coord(a), coord(b), coord(c), coord(d)), 0.0);
        assert_ne!(orient3d(a, b, c, d), 0);
    }
}
