//! Normals of triangles and of pairs of edges, with about 106 bits.

use glam::DVec3;
use num_bigint::BigInt;

use super::hull::Hull;
use crate::geometry::binary64::Binary64;
use crate::geometry::double_double::DoubleDouble;
use crate::geometry::exact_orientation::integers;

/// A vector of [`DoubleDouble`] numbers.
pub(super) type Vector = [DoubleDouble; 3];

/// The largest component of a cross product of edges that may be a rounding error, if components of edges are at most 1: 2^-95.
const ROUNDING: f64 = f64::from_bits((1023 - 95) << 52);

/// Returns the difference `q - p`, exactly.
pub(super) fn difference(q: DVec3, p: DVec3) -> Vector {
    std::array::from_fn(|k| DoubleDouble::difference(q[k], p[k]))
}

/// Returns the scalar product.
pub(super) fn dot(u: &Vector, v: &Vector) -> DoubleDouble {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

/// Returns a vector rounded to doubles.
pub(super) fn to_dvec3(v: &Vector) -> DVec3 {
    DVec3::from_array(v.map(DoubleDouble::to_f64))
}

/// Returns the vector times the power of two that brings its largest component into [1/2, 1). None for 0.
pub(super) fn normalize(v: &Vector) -> Option<Vector> {
    let exponent = binary_exponent(to_dvec3(v).abs().max_element())?;
    Some(v.map(|x| x.times_power_of_two(-exponent)))
}

/// Returns the e with `2^(e - 1) <= x < 2^e`. None for 0.
pub(super) fn binary_exponent(x: f64) -> Option<i32> {
    let Binary64 { mantissa, exponent } = Binary64::of(x);
    (mantissa != 0).then(|| exponent as i32 - 1075 + 64 - mantissa.unsigned_abs().leading_zeros() as i32)
}

/// Returns the edges of a triangle, each normalized. None for an edge whose ends are equal.
pub(super) fn edges(corners: &[DVec3; 3]) -> [Option<Vector>; 3] {
    std::array::from_fn(|i| normalize(&difference(corners[(i + 1) % 3], corners[i])))
}

/// Returns a normal of two normalized edges and its size before normalization, which is within a factor of 6 of the sine of the
/// angle between them. None for parallel edges, and if all digits may be lost.
pub(super) fn cross(e: &Vector, f: &Vector) -> Option<(f64, Vector)> {
    let minor = |i: usize, j: usize| e[i] * f[j] - e[j] * f[i];
    let normal = [minor(1, 2), minor(2, 0), minor(0, 1)];
    let size = to_dvec3(&normal).abs().max_element();
    if size <= ROUNDING {
        return None;
    }
    Some((size, normalize(&normal)?))
}

/// Returns the normal of a triangle, normalized. It is computed from the two edges whose cross product is largest. None
/// if [`cross`] returns none for all of them.
pub(super) fn normal(edges: &[Option<Vector>; 3]) -> Option<Vector> {
    let mut best: Option<(f64, Vector)> = None;
    for i in 0..3 {
        let candidate = edges[i].zip(edges[(i + 1) % 3]).and_then(|(e, f)| cross(&e, &f));
        if let Some(candidate) = candidate
            && best.is_none_or(|best| candidate.0 > best.0)
        {
            best = Some(candidate);
        }
    }
    best.map(|(_, normal)| normal)
}

/// Returns the unit normal of a triangle, on the side from which its corners turn counterclockwise; 0 if it is
/// degenerate.
pub(super) fn unit_normal(hull: &Hull<'_>) -> DVec3 {
    if !hull.is_triangle() {
        return DVec3::ZERO;
    }
    let rounded = normal(&edges(hull.corners)).map(|normal| to_dvec3(&normal));
    rounded.unwrap_or_else(|| exact_normal(hull.corners)).normalize()
}

/// Returns a multiple of the normal of a triangle whose edges are parallel up to about 2^-95, from integers.
#[cold]
#[inline(never)]
fn exact_normal(corners: &[DVec3; 3]) -> DVec3 {
    const BITS: u64 = 60;
    let [a, b, c] = integers(corners.map(|p| p.to_array()));
    let [q, r]: [[BigInt; 3]; 2] = [b, c].map(|p| std::array::from_fn(|k| &p[k] - &a[k]));
    let normal = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &q[i] * &r[j] - &q[j] * &r[i]);
    let excess = normal.iter().map(BigInt::bits).max().unwrap_or(0).saturating_sub(BITS);
    DVec3::from_array(normal.map(|x| i64::try_from(x >> excess).map_or(0.0, |x| x as f64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_above_the_number() {
        let exponents = [0.75, 1.0, 3.0, f64::from_bits(1), 0.0].map(binary_exponent);
        assert_eq!(exponents, [Some(0), Some(1), Some(2), Some(-1073), None]);
    }

    #[test]
    fn normals_are_cross_products() {
        // Edges (3, 1, -1) and (2, 5, 5).
        let corners = [[1.0, 2.0, 4.0], [4.0, 3.0, 3.0], [3.0, 7.0, 9.0]].map(DVec3::from_array);
        let expected = DVec3::new(10.0, -17.0, 13.0).normalize();
        assert!(exact_normal(&corners).normalize().distance(expected) < 1e-15);
        assert!(unit_normal(&Hull::of(&corners)).distance(expected) < 1e-15);
        // Two edges are parallel up to 2^-90: their cross product has about 16 bits.
        let (v, w) = (DVec3::new(0.3, -0.7, 0.45), DVec3::new(0.8, 0.35, -0.6));
        let needle = [-v, DVec3::ZERO, w * 2.0_f64.powi(-90)];
        assert!(unit_normal(&Hull::of(&needle)).distance(v.cross(w).normalize()) < 1e-14);
        // All edges are parallel up to 2^-120.
        let flat = [DVec3::NEG_X, DVec3::new(1.0, 2.0_f64.powi(-120), 0.0), DVec3::ZERO];
        assert_eq!(unit_normal(&Hull::of(&flat)), DVec3::NEG_Z);
    }
}
