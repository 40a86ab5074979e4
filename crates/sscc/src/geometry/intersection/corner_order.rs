//! The order of corners around a convex polygon, from the features on which they lie.

use super::feature::IntersectionPoint;

/// Sorts the corners of the polygon in which two triangles in one plane meet, so that neighbours are adjacent. Begins with
/// the corner of the lowest features.
///
/// Each edge of the polygon is in an edge of one of the triangles, and a line contains at most two corners of a convex
/// polygon. So two corners are neighbours exactly if they are on one closed edge. No coordinate is compared.
pub(super) fn sort_around(corners: &mut [IntersectionPoint]) {
    corners.sort_unstable_by_key(|corner| corner.features);
    for i in 1..corners.len() {
        if let Some(next) = (i..corners.len()).find(|&j| are_neighbours(&corners[i - 1], &corners[j])) {
            corners[i..=next].rotate_right(1);
        }
    }
}

fn are_neighbours(p: &IntersectionPoint, q: &IntersectionPoint) -> bool {
    (0..2)
        .any(|side| (0..3).any(|edge| p.features[side].is_on_edge(edge) && q.features[side].is_on_edge(edge)))
}
