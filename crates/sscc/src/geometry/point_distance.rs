//! The distance of a point from a triangle.

use glam::DVec3;

/// Returns the distance of a point from a triangle, rounded. It is that of some point of the triangle, so only rounding
/// makes it too small. It is at most the computed distance of the nearest point of an edge.
pub(crate) fn distance_point_triangle(point: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let from_segment = |p: DVec3, q: DVec3| {
        let (along, offset) = (q - p, point - p);
        let share = offset.dot(along) / along.length_squared();
        // The share is NaN for a segment without length: then its end is taken.
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        (offset - along * share).length_squared()
    };
    let edges = from_segment(*a, *b).min(from_segment(*b, *c)).min(from_segment(*c, *a));
    let (u, v, w) = (*b - *a, *c - *a, point - *a);
    let normal = u.cross(v);
    let square = normal.length_squared();
    let (beta, gamma) = (w.cross(v).dot(normal) / square, u.cross(w).dot(normal) / square);
    let is_inside = beta >= 0.0 && gamma >= 0.0 && beta + gamma <= 1.0;
    let inside = if is_inside { (w - u * beta - v * gamma).length_squared() } else { f64::INFINITY };
    edges.min(inside).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_beyond_the_third_edge_are_at_its_distance() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert_eq!(distance_point_triangle(DVec3::ONE, &triangle), 1.5_f64.sqrt());
        assert_eq!(distance_point_triangle(DVec3::new(0.25, 0.25, 1.0), &triangle), 1.0);
    }
}
