//! Points and simplices: barycentric coordinates and nearest points.

use glam::{DMat3, DVec3};

/// Returns the barycentric coordinates of a point in a tetrahedron that is not flat; negative ones outside.
pub fn barycentric(x: DVec3, [a, b, c, d]: [DVec3; 4]) -> [f64; 4] {
    let w = DMat3::from_cols(b - a, c - a, d - a).inverse() * (x - a);
    [1.0 - w.x - w.y - w.z, w.x, w.y, w.z]
}

/// Returns the nearest point of a tetrahedron that is not flat.
pub fn nearest_point_tetrahedron(x: DVec3, corners: [DVec3; 4]) -> DVec3 {
    let weights = barycentric(x, corners);
    if weights.iter().all(|w| *w >= 0.0) {
        return x;
    }
    // The nearest point is on a face that x is beyond.
    nearest(
        x,
        (0..4).filter(|k| weights[*k] < 0.0).map(|k| {
            let face = [1, 2, 3].map(|n| corners[(k + n) % 4]);
            nearest_point_triangle(x, face)
        }),
    )
}

fn nearest_point_triangle(x: DVec3, corners: [DVec3; 3]) -> DVec3 {
    let [a, b, c] = corners;
    let (ab, ac) = (b - a, c - a);
    let w = DMat3::from_cols(ab, ac, ab.cross(ac)).inverse() * (x - a);
    let weights = [1.0 - w.x - w.y, w.x, w.y];
    if weights.iter().all(|w| *w >= 0.0) {
        return a + ab * w.x + ac * w.y;
    }
    nearest(
        x,
        (0..3).filter(|k| weights[*k] < 0.0).map(|k| {
            let [a, b] = [1, 2].map(|n| corners[(k + n) % 3]);
            let along = b - a;
            a + along * ((x - a).dot(along) / along.length_squared()).clamp(0.0, 1.0)
        }),
    )
}

/// Returns the point nearest to x; x itself if there is none.
fn nearest(x: DVec3, points: impl Iterator<Item = DVec3>) -> DVec3 {
    let distance = |p: &DVec3| p.distance_squared(x);
    points.min_by(|p, q| distance(p).total_cmp(&distance(q))).unwrap_or(x)
}
