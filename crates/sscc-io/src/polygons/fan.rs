//! Checks whether the fan around the first corner triangulates a polygon.

use glam::DVec2;
use sscc::parts::orient2d;

/// Whether the fan around the first corner covers the polygon, and covers no point twice, apart from borders.
///
/// This holds if no two triangles of the fan have opposite orientations, and the polygon goes around its first corner at
/// most once. A polygon without area is the union of its fan's segments.
pub(super) fn is_fan_a_triangulation(polygon: &[DVec2]) -> bool {
    let [center, others @ ..] = polygon else { return true };
    let mut turn = 0;
    for edge in others.windows(2) {
        let side = orient2d(*center, edge[0], edge[1]);
        if side != 0 && side == -turn {
            return false;
        }
        turn = if side == 0 { turn } else { side };
    }
    // The directions from the centre to the corners rotate in one sense, by at most 180 degrees at each step (180 degrees if
    // an edge goes through the centre). They have passed the first direction again if one is ahead of it after another was
    // behind it or opposite to it.
    let Some(start) = others.iter().find(|p| *p != center) else { return true };
    let is_between = |a: f64, x: f64, b: f64| a < x && x < b || b < x && x < a;
    // For a point on the line through the centre and `start`: whether the centre is between the point and `start`.
    let is_opposite = |p: &DVec2| is_between(start.x, center.x, p.x) || is_between(start.y, center.y, p.y);
    let mut was_behind = false;
    for point in others {
        match orient2d(*center, *start, *point) * turn {
            1 if was_behind => return false,
            -1 => was_behind = true,
            0 if is_opposite(point) => was_behind = true,
            _ => {}
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_fan(points: &[(f64, f64)]) -> bool {
        let points: Vec<DVec2> = points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect();
        let mirrored: Vec<DVec2> = points.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
        let found = is_fan_a_triangulation(&points);
        assert_eq!(is_fan_a_triangulation(&mirrored), found);
        found
    }

    #[test]
    fn convex_and_star_shaped_polygons_are_fans() {
        assert!(is_fan(&[(0., 0.), (4., 0.), (4., 4.), (0., 4.)]));
        // The whole polygon is visible from its reflex first corner, but not from another corner.
        let arrow = [(2., 1.), (0., 4.), (0., 0.), (4., 0.), (4., 4.)];
        assert!(is_fan(&arrow));
        let mut turned = arrow;
        turned.rotate_left(2);
        assert!(!is_fan(&turned));
        // Corners on edges, repeated corners, no area.
        assert!(is_fan(&[(0., 0.), (2., 0.), (4., 0.), (4., 4.), (2., 4.), (0., 4.), (0., 2.)]));
        assert!(is_fan(&[(0., 0.), (0., 0.), (4., 0.), (4., 0.), (4., 4.), (0., 4.)]));
        assert!(is_fan(&[(0., 0.), (2., 0.), (1., 0.), (3., 0.)]) && is_fan(&[(1., 1.); 5]));
        assert!(is_fan(&[]) && is_fan(&[(0., 0.)]));
    }

    #[test]
    fn crossing_and_twice_turning_polygons_are_no_fans() {
        assert!(!is_fan(&[(0., 0.), (4., 4.), (4., 0.), (0., 4.)]));
        // The polygon goes around its first corner twice.
        let ring = [(2., 0.), (0., 2.), (-2., 0.), (0., -2.), (3., 0.), (0., 3.), (-3., 0.), (0., -3.)];
        let twice: Vec<_> = [(0., 0.)].into_iter().chain(ring).collect();
        assert!(!is_fan(&twice));
        assert!(is_fan(&twice[..5]));
        // The same triangle twice, with an edge through the first corner between.
        assert!(!is_fan(&[(0., 0.), (1., 0.), (0., 1.), (-1., 0.), (1., 0.), (0., 1.)]));
        // The first corner is on an edge.
        assert!(is_fan(&[(0., 0.), (1., 0.), (0., 1.), (-1., 0.)]));
    }
}
