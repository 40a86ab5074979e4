//! Exact intersection tests of closed shapes in the plane, and the projections that bring shapes in space there.
//!
//! A coordinate projection drops one coordinate, which is exact. On a plane (or a line) in space at least
//! one of the three projections is injective, and an injective affine map preserves intersections.

use glam::{DVec2, DVec3};

use super::orientation::{is_strictly_one_side, orient2d};

/// The coordinate projections, by the axis of the dropped coordinate.
pub(super) const AXES: [usize; 3] = [0, 1, 2];

/// Returns the point without the coordinate of that axis.
#[inline]
pub(super) fn project(point: DVec3, axis: usize) -> DVec2 {
    match axis {
        0 => DVec2::new(point.y, point.z),
        1 => DVec2::new(point.z, point.x),
        _ => DVec2::new(point.x, point.y),
    }
}

/// Returns an axis whose projection is injective on the triangle's plane. None if the triangle is degenerate.
///
/// The orientation in the projection along an axis is that component of the triangle's normal. The
/// corners are collinear exactly if all three are 0; a projection is injective on the plane exactly if
/// its component is not.
pub(super) fn injective_projection(triangle: &[DVec3; 3]) -> Option<usize> {
    AXES.into_iter().find(|axis| {
        let [a, b, c] = triangle.map(|p| project(p, *axis));
        orient2d(a, b, c) != 0
    })
}

/// Whether two closed triangles, neither degenerate, have a point in common.
///
/// `A - B`, all differences of their points, is a convex polygon. Its edges have the outward normals of A's
/// edges and the inward normals of B's. The triangles are disjoint exactly if it does not contain 0, which
/// is if 0 is strictly beyond one of its edges, which is if one triangle is strictly beyond an edge of the
/// other.
pub(super) fn intersect_triangle_triangle_2d(a: [DVec2; 3], b: [DVec2; 3]) -> bool {
    !is_beyond_an_edge(a, &b) && !is_beyond_an_edge(b, &a)
}

/// Whether a closed segment, which may be a point, and a closed triangle that is not degenerate have a
/// point in common.
///
/// The proof is that for two triangles; the segment is an edge with two normals, and a point has no edge at all.
pub(super) fn intersect_segment_triangle_2d(segment: [DVec2; 2], triangle: [DVec2; 3]) -> bool {
    let [p, q] = segment;
    !is_beyond_an_edge(triangle, &segment) && !is_strictly_one_side(&triangle.map(|c| orient2d(p, q, c)))
}

/// Whether two closed segments, each of which may be a point, have a point in common.
///
/// They do exactly if their boxes meet and neither is strictly on one side of the other's line. These conditions are clearly
/// necessary. Conversely, if the lines are two that cross, then the crossing point is on both segments. If the lines are
/// parallel, they are the same, and on a line segments meet exactly if their boxes do. If one or both are points, the first is on
/// the other's line (or both are points), and again the boxes decide.
pub(super) fn intersect_segment_segment_2d(a: [DVec2; 2], b: [DVec2; 2]) -> bool {
    let boxes_meet = a[0].min(a[1]).cmple(b[0].max(b[1])).all() && b[0].min(b[1]).cmple(a[0].max(a[1])).all();
    boxes_meet
        && !is_strictly_one_side(&b.map(|p| orient2d(a[0], a[1], p)))
        && !is_strictly_one_side(&a.map(|p| orient2d(b[0], b[1], p)))
}

/// Whether all points are strictly beyond the same edge of a triangle that is not degenerate.
fn is_beyond_an_edge(triangle: [DVec2; 3], points: &[DVec2]) -> bool {
    let [a, b, c] = triangle;
    let inside = orient2d(a, b, c);
    [(a, b), (b, c), (c, a)]
        .into_iter()
        .any(|(start, end)| points.iter().all(|p| orient2d(start, end, *p) == -inside))
}
