//! Distance of two triangles, in plain floating-point arithmetic.

use glam::DVec3;

/// Returns the distance of two triangles that do not intersect.
pub fn distance_triangle_triangle(x: &[DVec3; 3], y: &[DVec3; 3]) -> f64 {
    let edges = |[a, b, c]: [DVec3; 3]| [[a, b], [b, c], [c, a]];
    let between_edges = edges(*x).into_iter().flat_map(|a| edges(*y).map(|b| distance_segment_segment(a, b)));
    let to_faces =
        x.iter().map(|p| distance_vertex_face(*p, y)).chain(y.iter().map(|p| distance_vertex_face(*p, x)));
    between_edges.chain(to_faces).fold(f64::INFINITY, f64::min)
}

/// Returns the distance of a point from a triangle whose face holds the point's projection; infinite if the projection
/// is outside, where an edge is nearer.
fn distance_vertex_face(p: DVec3, &[a, b, c]: &[DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) && normal != DVec3::ZERO {
        (p - a).dot(normal.normalize()).abs()
    } else {
        f64::INFINITY
    }
}

/// Returns the distance of two segments (Ericson 2005, *Real-Time Collision Detection*, 5.1.9).
fn distance_segment_segment([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, vv, uv, uw, vw) = (u.dot(u), v.dot(v), u.dot(v), u.dot(w), v.dot(w));
    let clamped = |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    let s = clamped(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = clamped(uv * s + vw, vv);
    let s = clamped(uv * t - uw, uu);
    (a + u * s).distance(c + v * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_equal_known_values() {
        let x = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let moved = |by: DVec3| x.map(|p| p + by);
        assert_eq!(distance_triangle_triangle(&x, &moved(DVec3::Z * 0.5)), 0.5); // a vertex and a face, two edges
        assert_eq!(distance_triangle_triangle(&x, &moved(DVec3::X * 3.0)), 2.0); // two vertices
        let needle = [DVec3::new(0.25, 0.25, 0.125), DVec3::new(0.25, 0.25, 1.0), DVec3::new(0.25, 0.5, 2.0)];
        assert_eq!(
            [distance_triangle_triangle(&x, &needle), distance_triangle_triangle(&needle, &x)],
            [0.125; 2]
        ); // a vertex and a face only
        let across = [DVec3::new(0.5, -1.0, 0.25), DVec3::new(0.5, 1.0, 0.25), DVec3::new(0.5, 0.0, 4.0)];
        assert_eq!(distance_triangle_triangle(&[DVec3::ZERO, DVec3::X, DVec3::X], &across), 0.25); // two edges only
    }
}
