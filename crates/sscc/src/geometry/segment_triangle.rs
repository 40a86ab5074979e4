//! The exact intersection test of a closed segment and a closed triangle in space.

use glam::DVec3;

use super::orientation::{Plane, is_strictly_one_side, orient3d};
use super::planar::{injective_projection, intersect_segment_triangle_2d, project};

/// Whether a closed segment, which may be a point, and a closed triangle that is not degenerate have a
/// point in common.
pub(super) fn intersect_segment_triangle(segment: [DVec3; 2], triangle: &[DVec3; 3]) -> bool {
    let plane = Plane::through(triangle);
    let [p, q] = segment;
    let sides = [plane.side(p), plane.side(q)];
    if is_strictly_one_side(&sides) {
        return false;
    }
    if sides == [0, 0] {
        return injective_projection(triangle).is_some_and(|axis| {
            let project = |x| project(x, axis);
            intersect_segment_triangle_2d(segment.map(project), triangle.map(project))
        });
    }
    // The line crosses the plane at one point x, which is on the segment. The volume of p, q and an edge is
    // (q - p) . ((start - x) x (end - x)): the barycentric coordinate of x opposite to that edge, times
    // (q - p) . normal, which is not 0. So the coordinates are all >= 0 (as their sum is 1, they cannot be
    // all <= 0) exactly if the volumes do not have both signs.
    let [a, b, c] = *triangle;
    let volumes = [orient3d(p, q, a, b), orient3d(p, q, b, c), orient3d(p, q, c, a)];
    volumes.iter().all(|v| *v >= 0) || volumes.iter().all(|v| *v <= 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A segment that ends strictly on one side of the plane is disjoint from the triangle.
    #[test]
    fn a_segment_that_ends_before_the_plane_is_disjoint() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let from = DVec3::new(0.25, 0.25, 1.0);
        for (z, expected) in
            [(-1.0, true), (0.0, true), (f64::from_bits(1), false), (0.5, false), (2.0, false)]
        {
            let segment = [from, DVec3::new(0.25, 0.25, z)];
            assert_eq!(intersect_segment_triangle(segment, &triangle), expected, "{z}");
        }
    }
}
