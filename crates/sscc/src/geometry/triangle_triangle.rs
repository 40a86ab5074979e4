//! The exact intersection test of two closed triangles in space.
//!
//! Two triangles in crossing planes are compared as intervals of the planes' common line, by signs of orientation
//! determinants alone (Guigue and Devillers 2003, *Fast and Robust Triangle-Triangle Overlap Test Using Orientation
//! Predicates*). All else is reduced to segments or to the plane.

use glam::DVec3;

use super::orientation::{Plane, orient3d};
use super::planar::{injective_projection, intersect_triangle_triangle_2d, project};
use super::segment_segment::intersect_segment_segment;
use super::segment_triangle::intersect_segment_triangle;
use crate::limits;

/// Whether two closed triangles have a point in common, decided exactly.
///
/// A triangle is the convex hull of its three corners (in any order; any unit, the same for both). So a
/// degenerate one is the segment or point that its corners span. Touching counts: a common corner, a corner
/// on a face, crossing edges, coplanar triangles that overlap. Both answers are exact for the coordinates
/// as given, without any tolerance: "no" is a proof that the triangles are disjoint, "yes" that they meet.
///
/// Coordinates must be finite and at most [`limits::LARGEST`] in magnitude (checked in debug builds only;
/// beyond, the answer may be wrong). They may be arbitrarily small, denormal numbers included.
///
/// The test is fast if one triangle is clearly on one side of the other's plane. The test does not compare AABBs: compare them
/// first if many pairs are far apart, or in one plane (the slow case: signs that are 0 need exact arithmetic).
///
/// ```
/// use glam::DVec3;
/// use sscc::intersect_triangle_triangle;
///
/// let a = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// let touching = [DVec3::new(0.25, 0.25, 0.0), DVec3::Z, DVec3::ONE];
/// let above = touching.map(|p| p + DVec3::Z * f64::EPSILON);
/// assert!(intersect_triangle_triangle(&a, &touching));
/// assert!(!intersect_triangle_triangle(&a, &above));
/// ```
pub fn intersect_triangle_triangle(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    debug_assert!(a.iter().chain(b).all(|p| limits::contains(*p)), "corner out of range: {a:?} {b:?}");
    intersect_beyond_limits(a, b)
}

/// Decides [`intersect_triangle_triangle`] for coordinates up to four times [`limits::LARGEST`]: corners relative to one of
/// them are up to twice as large as the corners.
pub(super) fn intersect_beyond_limits(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let Some(sides_of_b) = Plane::through(a).sides_unless_separated(b) else {
        return false;
    };
    let Some(sides_of_a) = Plane::through(b).sides_unless_separated(a) else {
        return false;
    };
    if sides_of_a == [0; 3] || sides_of_b == [0; 3] {
        return intersect_flat(a, b);
    }
    intersect_crossing(a, sides_of_a, b, sides_of_b)
}

/// Decides the case of two crossing planes: both triangles have a corner off the other's plane (so neither is degenerate), and
/// neither is strictly on one side.
///
/// The planes meet in a line L, and each triangle meets the other's plane in an interval of L: the triangles
/// meet exactly if the intervals overlap. Let `a0` be the corner of a whose side is the only greatest, or
/// the only least; there is one, because the sides are not all equal. Then the lines `a0 a1` and `a0 a2`
/// cross the plane of b at one point each, and these points i and j are the ends of the interval; k and l
/// are those of b, on `b0 b1` and `b0 b2`. Exchanging `b1, b2` turns over the plane of b, so we may assume
/// that `a0` is the greatest, and the same for `b0`.
///
/// Let M and N be the normals of a and b, and orient L along `D = M x N`. Then, as in the plane of a the
/// corner `a0` is on the upper side of b and `a0, a1, a2` turn left about M, j comes before i (or is equal);
/// in the plane of b, k comes before l. So the intervals are [j, i] and [k, l], and overlap exactly if
/// `j <= l` and `k <= i`. Such positions are compared by a determinant:
/// `det(a1 - a0, b0 - a0, b1 - a0) = det(a0 - a1, k - i, b0 - b1)`, because `a0 - i` is parallel to
/// `a0 - a1` and `b0 - k` to `b0 - b1`. With `k - i = t D` this is `t (a0 - a1) . (D x (b0 - b1))`. As
/// `b0 - b1` points to the upper side of a within the plane of b, `D x (b0 - b1)` is a positive multiple of N,
/// and `(a0 - a1) . N > 0`: the determinant has the sign of t. The same holds for any two of the ends.
fn intersect_crossing(a: &[DVec3; 3], sides_of_a: [i8; 3], b: &[DVec3; 3], sides_of_b: [i8; 3]) -> bool {
    let (apex_a, apex_b) = (find_apex(sides_of_a), find_apex(sides_of_b));
    let [a0, a1, a2] = reorder(a, apex_a.corner, apex_b.is_above);
    let [b0, b1, b2] = reorder(b, apex_b.corner, apex_a.is_above);
    let touch = with_mutant!(0, TouchingIsFree, 1);
    orient3d(a0, a1, b0, b1) <= -touch && orient3d(a0, a2, b0, b2) >= touch
}

/// The corner of a triangle that is alone on its side of the other's plane.
#[derive(Clone, Copy)]
struct Apex {
    corner: usize,
    /// Whether its side is the greatest of the three, else the least.
    is_above: bool,
}

/// Finds the apex: three numbers that are not all equal have an only greatest or an only least one.
#[inline]
fn find_apex(sides: [i8; 3]) -> Apex {
    let [s0, s1, s2] = sides;
    let corner = if s1 == s2 {
        0
    } else if s0 == s2 {
        1
    } else if s0 == s1 {
        2
    } else {
        // -1, 0, 1 in some order: the greatest and the least are both alone. This takes the greatest.
        usize::from(s1 > 0) + 2 * usize::from(s2 > 0)
    };
    Apex { corner, is_above: sides[corner] > sides[(corner + 1) % 3] }
}

/// Returns the corners, beginning with the given one, in the same orientation or the opposite one.
#[inline]
fn reorder(corners: &[DVec3; 3], first: usize, same_orientation: bool) -> [DVec3; 3] {
    let (second, third) = ((first + 1) % 3, (first + 2) % 3);
    let (second, third) = if same_orientation { (second, third) } else { (third, second) };
    [corners[first], corners[second], corners[third]]
}

/// Decides the case of a degenerate triangle, or of two triangles in one plane.
#[cold]
#[inline(never)]
fn intersect_flat(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    match (injective_projection(a), injective_projection(b)) {
        // Neither is degenerate, so the caller found all corners of one in the other's plane.
        (Some(axis), Some(_)) => {
            intersect_triangle_triangle_2d(a.map(|p| project(p, axis)), b.map(|p| project(p, axis)))
        }
        (None, Some(_)) => intersect_segment_triangle(hull_of_collinear(a), b),
        (Some(_), None) => intersect_segment_triangle(hull_of_collinear(b), a),
        (None, None) => intersect_segment_segment(hull_of_collinear(a), hull_of_collinear(b)),
    }
}

/// Returns the ends of the segment that three collinear corners span.
///
/// Points on a line are ordered by the first coordinate that differs; hence the lexicographically least and greatest
/// corners are the ends.
fn hull_of_collinear(corners: &[DVec3; 3]) -> [DVec3; 2] {
    let mut ends = [corners[0]; 2];
    for &corner in &corners[1..] {
        if corner.to_array() < ends[0].to_array() {
            ends[0] = corner;
        }
        if corner.to_array() > ends[1].to_array() {
            ends[1] = corner;
        }
    }
    ends
}
