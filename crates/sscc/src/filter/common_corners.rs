//! Decides whether triangles with common corners have a point in common beyond these corners and the edges between them.

use glam::DVec3;

use crate::geometry::{intersect_shared_edge_pair, intersect_shared_vertex_pair};
use crate::intersect_triangle_triangle;

/// The corners of a triangle, and their vertex classes.
#[derive(Clone, Copy)]
pub(super) struct ClassedCorners<'a> {
    pub(super) positions: &'a [DVec3; 3],
    pub(super) classes: [u32; 3],
}

impl ClassedCorners<'_> {
    /// Returns which corners are common: a corner of the other triangle has the same class, and is at the same position. Welded
    /// corners that have moved apart are no common point.
    fn common_with(&self, other: &Self) -> [bool; 3] {
        std::array::from_fn(|i| {
            let is_same =
                |j: usize| self.classes[i] == other.classes[j] && self.positions[i] == other.positions[j];
            (0..3).any(is_same)
        })
    }

    /// Returns the positions of the corners that are common, or of those that are not.
    fn corners_where(&self, is_wanted: [bool; 3]) -> impl Iterator<Item = DVec3> + use<> {
        let positions = *self.positions;
        (0..3).filter(move |i| is_wanted[*i]).map(move |i| positions[i])
    }
}

/// Whether two closed triangles have a point in common beyond their common corners, exactly. If `edges_are_common`, points on the
/// edges between these corners do not count either. The answer is yes for triangles all of whose corners are common: they are one
/// face twice.
#[cold] // By default no pair needs this; out of line, it keeps the test of pairs without common vertices small.
#[inline(never)]
pub(super) fn intersect_beyond_common_corners(
    a: ClassedCorners<'_>,
    b: ClassedCorners<'_>,
    edges_are_common: bool,
) -> bool {
    let (common_a, common_b) = (a.common_with(&b), b.common_with(&a));
    if common_a == [true; 3] && common_b == [true; 3] {
        return with_mutant!(true, DoubledFacesAreFree, false);
    }
    // There are at most two distinct positions: three would be all corners of both.
    let mut common = a.corners_where(common_a);
    let Some(u) = common.next() else {
        return intersect_triangle_triangle(a.positions, b.positions);
    };
    let edge = [u, common.find(|x| *x != u).unwrap_or(u)];
    if edge[0] != edge[1] && with_mutant!(!edges_are_common, EdgeOfOneVertexForgiven, false) {
        return true;
    }
    let mut others_a = a.corners_where(common_a.map(|is_common| !is_common));
    let mut others_b = b.corners_where(common_b.map(|is_common| !is_common));
    // A triangle whose corners are all common is a part of the edge.
    let (Some(first_a), Some(first_b)) = (others_a.next(), others_b.next()) else {
        return false;
    };
    if edge[0] == edge[1] {
        let [opposite_a, opposite_b] = [(first_a, others_a.next()), (first_b, others_b.next())]
            .map(|(first, second)| [first, second.unwrap_or(first)]);
        intersect_shared_vertex_pair(u, opposite_a, opposite_b)
    } else {
        intersect_shared_edge_pair(edge, first_a, first_b)
    }
}
