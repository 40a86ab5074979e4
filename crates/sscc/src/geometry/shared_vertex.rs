//! Two closed triangles with a common corner: do they meet anywhere else?

use glam::DVec3;

use super::orientation::{Plane, strictly_one_side};
use super::planar::injective_projection;
use super::segment_triangle::intersect_segment_triangle;
use super::triangle_triangle::intersect_triangle_triangle;

/// Whether the closed triangles `v, x0, x1` and `v, y0, y1` have a point in common other than v, decided exactly (as
/// [`intersect_triangle_triangle`], under the same conditions). Either may be degenerate.
///
/// Let neither opposite edge contain v. From v follow the ray through a common point until it leaves the first of
/// the two triangles: that point is on the edge opposite to v of that triangle, and in the other one. So
/// they meet elsewhere exactly if one's opposite edge meets the other triangle. A triangle whose opposite edge
/// contains v is degenerate: the union of the segments from v to its other corners, each of which is looked at as a
/// triangle of its own.
pub fn intersect_beyond_vertex(v: DVec3, x: [DVec3; 2], y: [DVec3; 2]) -> bool {
    let triangle = |[a, b]: [DVec3; 2]| [v, a, b];
    // A triangle that only touches the other's plane, with v, ends there. (A degenerate one has no
    // plane: all sides are 0.)
    let sides = |of: [DVec3; 2], edge: [DVec3; 2]| {
        let corners = triangle(of);
        let plane = Plane::through(&corners);
        edge.map(|p| plane.side(p))
    };
    if strictly_one_side(&sides(y, x)) || strictly_one_side(&sides(x, y)) {
        return false;
    }
    let meet = |e: [DVec3; 2], f: [DVec3; 2]| {
        intersect_edge_triangle(e, &triangle(f)) || intersect_edge_triangle(f, &triangle(e))
    };
    parts(v, x).any(|e| parts(v, y).any(|f| meet(e, f)))
}

/// Triangles with the corner v whose opposite edges do not contain it, together the triangle `v, a, b` (v alone where
/// there is none).
fn parts(v: DVec3, [a, b]: [DVec3; 2]) -> impl Iterator<Item = [DVec3; 2]> {
    let contains_v = intersect_edge_triangle([a, b], &[v; 3]);
    let parts = if contains_v { [[a, a], [b, b]] } else { [[a, b], [v, v]] };
    parts.into_iter().filter(move |part| *part != [v, v])
}

/// Whether a closed segment, which may be a point, and a closed triangle have a point in common.
fn intersect_edge_triangle([p, q]: [DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    let plane = Plane::through(triangle);
    let sides = [plane.side(p), plane.side(q)];
    if strictly_one_side(&sides) {
        return false;
    }
    if sides == [0, 0] && injective_projection(triangle).is_none() {
        return intersect_triangle_triangle(&[p, q, q], triangle);
    }
    intersect_segment_triangle([p, q], triangle)
}
