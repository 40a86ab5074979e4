//! The exact intersection test of a shared-edge pair: whether two closed triangles with a common edge have a point in
//! common beyond that edge.

use glam::DVec3;

use super::orientation::{Plane, orient2d};
use super::planar::{injective_projection, project};

/// Whether the closed triangles `u, w, a` and `u, w, b` have a point in common that is not on the edge from u to w,
/// decided exactly (as [`intersect_triangle_triangle`](crate::intersect_triangle_triangle), under the same conditions).
/// Either may be degenerate, and so may the edge.
///
/// Let L be the line of the edge.
/// - If neither triangle is degenerate, each meets L in the edge alone. In different planes they have no other common
///   point, as their planes meet in L. In one plane they have one exactly if a and b are on the same side of L: then both contain
///   a neighbourhood, on that side, of each inner point of the edge.
/// - If one of them is degenerate, it is a part of L, or the edge is a point and both are degenerate. The part meets the
///   other triangle in a part of the edge.
/// - If both are degenerate, they are segments that contain the edge. They have another common point exactly if they are on one
///   line and both reach beyond the same end of the edge. On a line, points are ordered by the first coordinate that differs.
pub fn intersect_shared_edge_pair([u, w]: [DVec3; 2], a: DVec3, b: DVec3) -> bool {
    let triangles = [[u, w, a], [u, w, b]];
    // Most edges are folded less than all the way. (Through collinear corners there is no plane: the side is 0.)
    if with_mutant!(Plane::through(&triangles[0]).side(b) != 0, HingesAreFlat, false) {
        return false;
    }
    match triangles.each_ref().map(injective_projection) {
        [Some(axis), Some(_)] => {
            let side = |p: DVec3| orient2d(project(u, axis), project(w, axis), project(p, axis));
            side(a) == side(b)
        }
        [None, None] => {
            let is_beyond = |p: DVec3| {
                let [u, w, p] = [u, w, p].map(|x| x.to_array());
                [p < u && p < w, p > u && p > w]
            };
            let is_one_line = injective_projection(&[u, a, b]).is_none();
            let [[a_before, a_after], [b_before, b_after]] = [a, b].map(is_beyond);
            is_one_line && (a_before && b_before || a_after && b_after)
        }
        _ => false,
    }
}
