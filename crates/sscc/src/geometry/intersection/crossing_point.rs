//! Computes the point where an edge crosses a face or another edge, in double precision.
//!
//! The callers have decided exactly that they cross, within the relative interiors of both. For an edge from p to q and a
//! plane with the signed distances `d_p` and `d_q` (times any factor), the point is `p + t (q - p)` with
//! `t = |d_p| / (|d_p| + |d_q|)`. No term cancels here, so t is as accurate as the distances. They are determinants, first
//! computed with about 106 bits, and in integers where these may not be enough.
//!
//! **Error.** Let P be the sum of the magnitudes of a determinant's products. Each goes through at most two products
//! (`7 u^2` each), the difference in the minor and two sums (`3 u^2` each) of [`DoubleDouble`] numbers: the error is less
//! than `32 u^2 P`. It is accepted up to `2^-58 (|d_p| + |d_q|)`, so that t errs by at most `2^-56` and the rounding of
//! the two distances' sum and quotient: `3 u t`. With `t <= 1/2` (else from q), a coordinate errs by at most
//! `(1.5 u + u / 8 + u) |q - p|` before, and `u |x|` in, the last sum: less than `u |x| + 3 u |q - p|` in all, with the
//! same coordinate of `q - p`.
//!
//! The result depends on the two point sets alone, not on the order of corners or of two edges. So all pairs of
//! triangles that share both features get the same position, bit for bit.

use std::ops::{Add, Mul, Sub};

use glam::DVec3;
use num_bigint::BigInt;

use super::hull::lexicographic;
use crate::geometry::aabb::Aabb;
use crate::geometry::double_double::DoubleDouble;
use crate::geometry::exact_orientation::{integers, is_robust_exact};

/// `u = 2^-53`.
const U: f64 = f64::EPSILON / 2.0;

/// Error of a determinant in [`DoubleDouble`] numbers, over the sum of the magnitudes of its products.
const DETERMINANT_ERROR: f64 = 32.0 * U * U;

/// Largest error of a distance, over the sum of both distances, with which t is accurate: 2^-58.
const MAX_DISTANCE_ERROR: f64 = U / 32.0;

/// Returns the point where an edge crosses the interior of a face.
pub(super) fn cross_edge_face(edge: [DVec3; 2], face: &[DVec3; 3]) -> DVec3 {
    let (edge, face) = (sorted(edge), sorted(*face));
    let points = [face[0], edge[0], edge[1], face[1], face[2]];
    let weights = weights(points, None).or_else(|| exact_weights(points, None));
    interpolate(edge, weights.unwrap_or([0.5; 2]), &face)
}

/// Returns the point where two edges in one plane cross. It is computed along the shorter one, up to rounding of the lengths.
pub(super) fn cross_edge_edge(e: [DVec3; 2], f: [DVec3; 2]) -> DVec3 {
    let (e, f) = (sorted(e), sorted(f));
    // Scaled, because squares of small numbers underflow.
    let length = |[p, q]: [DVec3; 2]| {
        let largest = (q - p).abs().max_element();
        if largest > 0.0 { largest * ((q - p) / largest).length() } else { 0.0 }
    };
    let is_e_first =
        length(e) < length(f) || length(e) == length(f) && e.map(|p| p.to_array()) < f.map(|p| p.to_array());
    let (e, f) = if is_e_first { (e, f) } else { (f, e) };
    let points = [f[0], e[0], e[1], f[1], f[1]];
    // In a projection in which the two lines differ, they cross at the projection of their crossing in space.
    let axes = || [0, 1, 2].into_iter().map(Some);
    let weights = axes()
        .find_map(|axis| weights(points, axis))
        .or_else(|| axes().find_map(|axis| exact_weights(points, axis)));
    interpolate(e, weights.unwrap_or([0.5; 2]), &f)
}

/// Returns `|d_p|` and `|d_q|` over their sum. None if [`DoubleDouble`] numbers may not be accurate enough.
///
/// The points are `o, p, q, r, s`. The plane contains o, r, and s; if an axis is given, it contains the direction of the axis in
/// place of s.
fn weights(points: [DVec3; 5], axis: Option<usize>) -> Option<[f64; 2]> {
    if !points.iter().flat_map(DVec3::as_ref).all(|x| is_robust_exact(*x)) {
        return None;
    }
    let [o, ..] = points;
    let differences = |p: DVec3| [0, 1, 2].map(|k| DoubleDouble::difference(p[k], o[k]));
    let differences: [[DoubleDouble; 3]; 4] = std::array::from_fn(|i| differences(points[i + 1]));
    let magnitudes = differences.map(|d| d.map(|x| Magnitude(x.to_f64().abs())));
    let [d_p, d_q] = distances(&differences, axis).map(DoubleDouble::abs);
    let [Magnitude(m_p), Magnitude(m_q)] = distances(&magnitudes, axis);
    let sum = (d_p + d_q).to_f64();
    let is_accurate = sum > 0.0 && DETERMINANT_ERROR * m_p.max(m_q) <= MAX_DISTANCE_ERROR * sum;
    with_mutant!(is_accurate, CrossingByDoubleDoubles, sum > 0.0)
        .then(|| [d_p, d_q].map(|d| d.to_f64() / sum))
}

/// Returns the numbers of [`weights`] from integers, with an absolute error of 2^-64 and rounding. None if both
/// distances are 0: then the axis is parallel to the plane of the two edges.
#[cold]
#[inline(never)]
fn exact_weights(points: [DVec3; 5], axis: Option<usize>) -> Option<[f64; 2]> {
    const BITS: u32 = 64;
    let points = integers(points.map(|p| p.to_array()));
    let differences: [[BigInt; 3]; 4] =
        std::array::from_fn(|i| std::array::from_fn(|k| &points[i + 1][k] - &points[0][k]));
    let [d_p, d_q] = distances(&differences, axis).map(|d| BigInt::from(d.magnitude().clone()));
    let sum = &d_p + &d_q;
    if sum == BigInt::ZERO {
        return None;
    }
    let unit = (1_u128 << BITS) as f64;
    Some([d_p, d_q].map(|d| u128::try_from((d << BITS) / &sum).map_or(1.0, |t| t as f64 / unit)))
}

/// The numbers in which determinants are computed.
trait Ring: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {}

impl<T: Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>> Ring for T {}

/// Returns the signed distances of p and q from the plane, times a common factor, given `p, q, r, s` relative to o.
fn distances<T: Ring>([p, q, r, s]: &[[T; 3]; 4], axis: Option<usize>) -> [T; 2] {
    let minor = |u: &[T; 3], v: &[T; 3], axis: usize| {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        u[i].clone() * v[j].clone() - u[j].clone() * v[i].clone()
    };
    if let Some(axis) = axis {
        return [minor(r, p, axis), minor(r, q, axis)];
    }
    let normal = [0, 1, 2].map(|axis| minor(r, s, axis));
    [p, q].map(|x| {
        let [x, y, z] = [0, 1, 2].map(|k| normal[k].clone() * x[k].clone());
        x + y + z
    })
}

/// An upper bound of a magnitude. A difference has the sum of the bounds.
#[derive(Clone, Copy)]
struct Magnitude(f64);

impl Add for Magnitude {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Magnitude {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.add(other)
    }
}

impl Mul for Magnitude {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
}

/// Returns the point of an edge, computed from its nearer end and clamped to the AABBs of the edge and of the other feature.
fn interpolate([p, q]: [DVec3; 2], [from_p, from_q]: [f64; 2], other: &[DVec3]) -> DVec3 {
    let x = if from_p <= from_q { p + (q - p) * from_p } else { q + (p - q) * from_q };
    [Aabb::of_points([p, q]), Aabb::of_points(other.iter().copied())]
        .iter()
        .fold(x, |x, aabb| x.max(aabb.lower).min(aabb.upper))
}

/// Returns the points in lexicographic order.
fn sorted<const N: usize>(mut points: [DVec3; N]) -> [DVec3; N] {
    points.sort_by(|p, q| lexicographic(*q, *p).cmp(&lexicographic(*p, *q)));
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn double_doubles_are_used_where_their_digits_suffice() {
        // The plane x + y + z = 0; p and q are `lift` beside it, on both sides.
        let points = |lift: f64, scale: f64| {
            let [p, q] = [lift, -lift].map(|lift| DVec3::new(1.0, 1.0, lift - 2.0));
            let (r, s) = (DVec3::new(1.0, 0.0, -1.0), DVec3::new(0.0, 1.0, -1.0));
            [DVec3::ZERO, p, q, r, s].map(|x| x * scale)
        };
        let (wide, narrow) = (2.0_f64.powi(-30), 2.0_f64.powi(-51));
        for scale in [1.0, 2.0_f64.powi(20), 2.0_f64.powi(-20)] {
            assert_eq!(weights(points(wide, scale), None), Some([0.5; 2]), "{scale}");
            assert_eq!(weights(points(narrow, scale), None), None, "{scale}");
            assert_eq!(exact_weights(points(narrow, scale), None), Some([0.5; 2]), "{scale}");
        }
        // Products of these coordinates may underflow.
        assert_eq!(weights(points(wide, 2.0_f64.powi(-250)), None), None);
    }

    #[test]
    fn crossings_are_computed_from_the_nearer_end_of_the_shorter_edge() {
        let around = [DVec3::splat(-9.0), DVec3::splat(9.0)];
        let near = interpolate([DVec3::ZERO, DVec3::ONE], [1e-30, 1.0], &around);
        assert_eq!(near, DVec3::splat(1e-30));
        // Along the long edge, the crossing would be rounded to 0.
        for scale in [1.0, 2.0_f64.powi(-600)] {
            let h = 2.0_f64.powi(-60);
            let long = [DVec3::NEG_X, DVec3::X].map(|p| p * scale);
            let short = [DVec3::new(0.0, -h, 0.0), DVec3::new(3.0 * h, h, 0.0)].map(|p| p * scale);
            let expected = DVec3::X * (1.5 * h * scale);
            assert_eq!(cross_edge_edge(long, short), expected, "{scale}");
            assert_eq!(cross_edge_edge(short, long), expected, "{scale}");
        }
    }
}
