//! The exact intersection test of a shared-vertex pair: whether two closed triangles with a common corner have another
//! point in common.

use glam::DVec3;

use super::orientation::{Plane, is_strictly_one_side};
use super::planar::injective_projection;
use super::segment_triangle::intersect_segment_triangle;
use super::triangle_triangle::intersect_triangle_triangle;

/// Whether the closed triangles `v, a0, a1` and `v, b0, b1` have a point in common other than v, decided exactly (as
/// [`intersect_triangle_triangle`], under the same conditions). Either may be degenerate.
///
/// Let neither opposite edge contain v. From v follow the ray through a common point until it leaves the first of
/// the two triangles: that point is on the edge opposite to v of that triangle, and in the other one. So
/// they meet elsewhere exactly if one's opposite edge meets the other triangle. A triangle whose opposite edge
/// contains v is degenerate: the union of the segments from v to its other corners, each of which is tested as a
/// triangle of its own.
pub fn intersect_shared_vertex_pair(v: DVec3, a: [DVec3; 2], b: [DVec3; 2]) -> bool {
    let triangle = |[p, q]: [DVec3; 2]| [v, p, q];
    // A triangle on one side of the other's plane, apart from v, meets it in v alone. (A degenerate one has no
    // plane: all sides are 0.)
    let sides = |of: [DVec3; 2], edge: [DVec3; 2]| {
        let corners = triangle(of);
        let plane = Plane::through(&corners);
        edge.map(|p| plane.side(p))
    };
    if is_strictly_one_side(&sides(b, a)) || is_strictly_one_side(&sides(a, b)) {
        return false;
    }
    let meet = |e: [DVec3; 2], f: [DVec3; 2]| {
        intersect_edge_triangle(e, &triangle(f)) || intersect_edge_triangle(f, &triangle(e))
    };
    parts(v, a).any(|e| parts(v, b).any(|f| meet(e, f)))
}

/// Returns the opposite edges of triangles with the corner v that together are the triangle `v, p, q`. None of these edges
/// contains v. Empty if the triangle is v alone.
fn parts(v: DVec3, [p, q]: [DVec3; 2]) -> impl Iterator<Item = [DVec3; 2]> {
    let contains_v = intersect_edge_triangle([p, q], &[v; 3]);
    let parts = if contains_v { [[p, p], [q, q]] } else { [[p, q], [v, v]] };
    parts.into_iter().filter(move |part| *part != [v, v])
}

/// Whether a closed segment, which may be a point, and a closed triangle have a point in common.
fn intersect_edge_triangle([p, q]: [DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    let plane = Plane::through(triangle);
    let sides = [plane.side(p), plane.side(q)];
    if is_strictly_one_side(&sides) {
        return false;
    }
    if sides == [0, 0] && injective_projection(triangle).is_none() {
        return intersect_triangle_triangle(&[p, q, q], triangle);
    }
    intersect_segment_triangle([p, q], triangle)
}
