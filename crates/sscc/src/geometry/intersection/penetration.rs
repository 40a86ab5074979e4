//! The smallest translation that separates two intersecting triangles.
//!
//! Let D be all differences `x - y` of points x of a and y of b: a convex polytope that contains 0. Translated by v, b
//! meets a exactly if v is in D. So the depth is the distance of 0 to the boundary of D, the smallest of its support
//! function `h(n) = max n . (a_i - b_j)` over the unit normals of its facets. A facet's normal is that of a, that of b,
//! or the cross product of an edge of each. Where D is flat, 0 is on its boundary: the depth is 0 along the
//! normal of D.
//!
//! **Accuracy.** No unit vector has an h below the depth, so an error of a normal makes the depth larger, never smaller.
//! Cross products are computed with about 106 bits: for edges at an angle of sine s, the direction errs by about
//! `2^-100 / s`. The facet of such edges is a strip of relative width s, so leaving it out errs by s times the
//! size of the pair at most. One of the two is below `2^-50`. If all are left out, D is so thin that any direction across it
//! suffices.

use glam::DVec3;

use super::feature::{Feature, Intersection};
use super::hull::{Hull, Shape};
use super::normal::{
    Vector, binary_exponent, cross, difference, dot, edges, normal, normalize, to_dvec3, unit_normal,
};
use super::triangle_triangle::TrianglePair;
use crate::geometry::double_double::{DoubleDouble, times_power_of_two};
use crate::limits;

/// The rounding error of the first, coarse value of h, with differences of at most 1: 2^-47.
const FIRST_LOOK_ERROR: f64 = f64::EPSILON * 32.0;

/// The smallest translation that separates two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Penetration {
    /// The length of the translation (model unit).
    pub depth: f64,
    /// The direction of the translation, a unit vector. The second triangle, moved by the depth along it, touches the first one
    /// without crossing it; so does the first one, moved the other way.
    pub direction: DVec3,
}

/// Returns the penetration depth of two closed triangles: the length and direction of the smallest translation after which they
/// only touch, so that any longer one separates them. None if they are disjoint.
///
/// The conditions are those of [`intersection_triangle_triangle`](crate::parts::intersection_triangle_triangle). The depth is
/// exactly 0 if the triangles touch without crossing: if they are in one plane or on one line, or if all common points are on the
/// boundary of one of them. Otherwise it is positive (at least the smallest denormal number), and too large by at most a few
/// units in the last place and `2^-48` times the largest difference of coordinates of a corner of each. If several directions are
/// equally good (up to rounding), the result has the first in a fixed order.
///
/// A call costs about three microseconds.
///
/// ```
/// use glam::DVec3;
/// use sscc::parts::penetration_triangle_triangle;
///
/// // The corner of b is 0.25 below a.
/// let a = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
/// let b = [DVec3::new(1.0, 1.0, -0.25), DVec3::new(1.0, 1.0, 2.0), DVec3::new(2.0, 1.0, 2.0)];
/// let Some(penetration) = penetration_triangle_triangle(&a, &b) else { panic!() };
/// assert_eq!(penetration.depth, 0.25);
/// assert_eq!(penetration.direction, DVec3::Z); // b, moved up
/// ```
pub fn penetration_triangle_triangle(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Penetration> {
    debug_assert!(a.iter().chain(b).all(|p| limits::contains(*p)), "corner out of range: {a:?} {b:?}");
    let pair = TrianglePair::of(a, b)?;
    Some(pair.penetration(&pair.intersection()?))
}

impl TrianglePair<'_> {
    /// Returns the penetration depth, given the common points.
    pub(super) fn penetration(&self, intersection: &Intersection) -> Penetration {
        if let Some(direction) = self.normal_of_flat() {
            return Penetration { depth: 0.0, direction };
        }
        let mut penetration = smallest_support(self.a.corners, self.b.corners);
        let is_touching = [&self.a, &self.b]
            .iter()
            .enumerate()
            .any(|(side, hull)| is_on_boundary(hull, intersection, side));
        if with_mutant!(is_touching, TouchingDepthRounded, false) {
            penetration.depth = 0.0;
        } else {
            // An exact depth above 0 can be below all doubles.
            penetration.depth = penetration.depth.max(f64::from_bits(1));
        }
        penetration
    }

    /// Returns the normal of all differences if they are in one plane, else None.
    fn normal_of_flat(&self) -> Option<DVec3> {
        let (a, b) = (&self.a, &self.b);
        match (a.is_triangle(), b.is_triangle()) {
            (true, _) => (self.sides[1] == [0; 3]).then(|| unit_normal(a)),
            (false, true) => (self.sides[0] == [0; 3]).then(|| unit_normal(b)),
            (false, false) => Some(normal_of_segments(a, b)),
        }
    }
}

/// Returns a unit vector that is orthogonal to two segments or points.
fn normal_of_segments(a: &Hull<'_>, b: &Hull<'_>) -> DVec3 {
    let edge = |hull: &Hull<'_>| match hull.shape {
        Shape::Segment(i) => edges(hull.corners)[i],
        _ => None,
    };
    let (e, f) = (edge(a), edge(b));
    match (e.zip(f).and_then(|(e, f)| cross(&e, &f)), e.or(f)) {
        (Some((_, normal)), _) => to_dvec3(&normal).normalize(),
        (None, Some(e)) => to_dvec3(&e).normalize().any_orthonormal_vector(),
        (None, None) => DVec3::X,
    }
}

/// Whether the common points are all on one edge of a triangle, or on an end of a segment.
///
/// Convex sets have a separating plane exactly if their relative interiors are disjoint. These are disjoint exactly if the common
/// points are in a proper face of one of the sets.
fn is_on_boundary(hull: &Hull<'_>, intersection: &Intersection, side: usize) -> bool {
    let points = intersection.points();
    match hull.shape {
        Shape::Point => false,
        Shape::Segment(_) => {
            points.iter().all(|p| matches!(p.features[side], Feature::Vertex(_))) && points.len() == 1
        }
        Shape::Triangle { .. } => (0..3).any(|i| points.iter().all(|p| p.features[side].is_on_edge(i))),
    }
}

/// Returns the smallest h over all candidates, and its direction.
fn smallest_support(a: &[DVec3; 3], b: &[DVec3; 3]) -> Penetration {
    let differences: [Vector; 9] = std::array::from_fn(|ij| difference(a[ij / 3], b[ij % 3]));
    let largest = differences.iter().map(|d| to_dvec3(d).abs().max_element()).fold(0.0, f64::max);
    let exponent = binary_exponent(largest).unwrap_or(0);
    let differences = differences.map(|d| d.map(|x| x.times_power_of_two(-exponent)));

    let mut candidates = candidates(a, b);
    if candidates.iter().all(Option::is_none) {
        candidates[0] = across(a, b);
    }
    let coarse = differences.map(|d| to_dvec3(&d));
    let first_look = candidates.iter().flatten().map(|normal| {
        let normal = to_dvec3(normal);
        let along = coarse.map(|d| normal.dot(d));
        let upper = along.iter().fold(f64::NEG_INFINITY, |m, x| m.max(*x));
        let lower = along.iter().fold(f64::INFINITY, |m, x| m.min(*x));
        upper.min(-lower) / normal.length()
    });
    let limit = first_look.clone().fold(f64::INFINITY, f64::min) + FIRST_LOOK_ERROR;

    let mut best = Penetration { depth: f64::INFINITY, direction: DVec3::X };
    for (normal, estimate) in candidates.iter().flatten().zip(first_look) {
        if estimate > limit {
            continue;
        }
        let along = differences.map(|d| dot(normal, &d));
        let length = dot(normal, normal).to_f64().sqrt();
        for sign in [1.0, -1.0] {
            let signed = |x: DoubleDouble| if sign > 0.0 { x } else { -x };
            let h = along.iter().fold(f64::NEG_INFINITY, |h, x| h.max(signed(*x).to_f64())) / length;
            if h < best.depth {
                best = Penetration { depth: h, direction: to_dvec3(normal) * (sign / length) };
            }
        }
    }
    Penetration { depth: times_power_of_two(best.depth.max(0.0), exponent), ..best }
}

/// Returns a unit vector perpendicular to the longest edge of both triangles. None if all edges are 0.
#[cold]
fn across(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Vector> {
    let all = [a, b].map(|t| [0, 1, 2].map(|i| difference(t[(i + 1) % 3], t[i])));
    let length = |e: &Vector| to_dvec3(e).abs().max_element();
    let longest = all.as_flattened().iter().max_by(|e, f| length(e).total_cmp(&length(f)))?;
    let along = to_dvec3(&normalize(longest)?).normalize();
    Some(difference(along.any_orthonormal_vector(), DVec3::ZERO))
}

/// Returns the normals of all possible facets of D, normalized: those of a, of b, and of each edge of a with each edge of b.
fn candidates(a: &[DVec3; 3], b: &[DVec3; 3]) -> [Option<Vector>; 11] {
    let (e, f) = (edges(a), edges(b));
    std::array::from_fn(|i| match i {
        9 => normal(&e),
        10 => normal(&f),
        _ => e[i / 3].zip(f[i % 3]).and_then(|(e, f)| cross(&e, &f)).map(|(_, normal)| normal),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All edges are parallel up to 2^-100, so no cross product has digits left.
    #[test]
    fn needles_along_one_line_have_a_depth() {
        let width = 2.0_f64.powi(-100);
        let a = [DVec3::NEG_X, DVec3::X, DVec3::Y * width];
        let b = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]].map(|[x, z]| DVec3::new(x, width / 4.0, width * z));
        assert!(candidates(&a, &b).iter().all(Option::is_none));
        let found = penetration_triangle_triangle(&a, &b).unwrap();
        assert!(found.depth > 0.0 && found.depth < 8.0 * width, "{found:?}");
        assert!(
            (found.direction.length() - 1.0).abs() < 1e-15 && found.direction.x.abs() < 1e-15,
            "{found:?}"
        );
    }
}
