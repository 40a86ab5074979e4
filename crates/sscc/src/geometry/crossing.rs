//! Decides exactly how a vertical ray crosses a triangle. The sum of crossings over a closed surface is its winding number.

use glam::{DVec3, Vec3Swizzles};

use super::orientation::{orient2d, orient3d};

/// Returns how the ray from a point towards +z crosses a triangle: 1 from the back to the front, -1 from the front to the back, 0
/// not at all.
///
/// The sum over a closed, consistently oriented surface that does not contain the point is the winding number of the
/// surface about it: the ray counts as moved by less than any positive number towards +x, and by far less towards +y,
/// so that it meets no edge and no vertical triangle.
pub(crate) fn crossing(point: DVec3, corners: &[DVec3; 3]) -> i32 {
    let p = point.xy();
    let mut turns = 0;
    for (u, v) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i].xy(), corners[j].xy())) {
        if u.y <= p.y && with_mutant!(p.y < v.y, CrossingsAtEnds, p.y <= v.y) {
            turns += i32::from(orient2d(u, v, p) > 0);
        } else if with_mutant!(v.y <= p.y && p.y < u.y, CrossingsUpwardAlone, false) {
            turns -= i32::from(orient2d(u, v, p) < 0);
        }
    }
    let [a, b, c] = *corners;
    // A triangle whose corners turn left as seen from above is above the point if the point is behind it.
    if turns != 0 && i32::from(orient3d(a, b, c, point)) * turns < 0 { turns } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Returns a cube of edge 2 about the origin, as triangles whose corners turn left as seen from outside.
    fn cube() -> Vec<[DVec3; 3]> {
        let corner = |i: usize| {
            DVec3::new(f64::from(i as u8 & 1), f64::from(i as u8 >> 1 & 1), f64::from(i as u8 >> 2))
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
        triangles.map(|t| t.map(|i| corner(i) * 2.0 - DVec3::ONE)).collect()
    }

    fn winding(surface: &[[DVec3; 3]], point: DVec3) -> i32 {
        surface.iter().map(|corners| crossing(point, corners)).sum()
    }

    /// Would fail if a ray through an edge, a corner or a vertical side were counted twice or not at all.
    #[test]
    fn points_below_edges_and_corners_are_counted_once() {
        let cube = cube();
        for x in [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0] {
            for y in [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0] {
                for z in [-2.0, -0.5, 0.0, 0.5, 2.0] {
                    let point = DVec3::new(x, y, z);
                    if point.abs().max_element() != 1.0 {
                        let is_inside = point.abs().max_element() < 1.0;
                        assert_eq!(winding(&cube, point), i32::from(is_inside), "{point}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_sum_is_the_winding_number_from_solid_angles() {
        let random = &mut Random(3);
        let mut inside = 0;
        for case in 0..400 {
            // A tetrahedron; in every fourth case flat, so that it has no inside.
            let mut corners = [(); 4].map(|()| random.vector());
            if case % 4 == 0 {
                corners.iter_mut().for_each(|x| x.z = 0.25);
            }
            let [a, b, c, d] = corners;
            let surface = [[a, c, b], [a, b, d], [b, c, d], [c, a, d]];
            let point = if case % 3 == 0 { (a + b + c + d) / 4.0 } else { random.vector() };
            let angle: f64 = surface
                .iter()
                .map(|t| {
                    let [a, b, c] = t.map(|x| (x - point).normalize());
                    2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
                })
                .sum();
            let expected = (angle / (4.0 * std::f64::consts::PI)).round() as i32;
            if case % 4 != 0 {
                assert_eq!(winding(&surface, point), expected, "{case}");
                inside += i32::from(expected != 0);
            } else if point.z != 0.25 {
                assert_eq!(winding(&surface, point), 0);
            }
        }
        assert!(inside > 80, "{inside}");
    }
}
