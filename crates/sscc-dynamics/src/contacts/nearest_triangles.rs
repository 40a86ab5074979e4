//! Nearest points of the features of two triangles, and the directions that separate the triangles.

use glam::DVec3;

use crate::nearest_point::{Feature, nearest_point_triangle};

/// Nearest points of a feature of each of two disjoint triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nearest {
    /// The points, the one of the first triangle first.
    pub points: [DVec3; 2],
    /// Unit vector from the second triangle to the first that separates them.
    pub normal: DVec3,
    /// The features: 1 to 3 for a corner of the first triangle, 4 to 6 for one of the second, 7 to 15 for two edges.
    pub features: u8,
}

/// Triangles nearer than this share of their size have no reliable direction between nearest points.
const MIN_DISTANCE: f64 = 1e-7;

/// Finds the nearest points of two disjoint triangles, and then those of all pairs of features (a corner and a face, or two
/// edges) whose nearest points lie in their interior, within a distance. Where triangles almost touch, the direction is the
/// normal of a face or of a pair of edges along which they are farthest apart. Finds nothing if all of these are zero.
pub(crate) fn nearest_features(a: &[DVec3; 3], b: &[DVec3; 3], range: f64, found: &mut Vec<Nearest>) {
    found.clear();
    let edges = |x: &[DVec3; 3]| (x[1] - x[0]).abs().max((x[2] - x[0]).abs()).max_element();
    let min_distance = MIN_DISTANCE * edges(a).max(edges(b));
    let mut best = (f64::INFINITY, [a[0], b[0]], 1);
    let mut consider = |points: [DVec3; 2], features: u8, is_interior: bool| {
        let between = points[0] - points[1];
        let distance = between.length();
        if distance < best.0 {
            best = (distance, points, features);
        }
        if is_interior && distance > min_distance && distance < range {
            found.push(Nearest { points, normal: between / distance, features });
        }
    };
    for n in 0..3 {
        let (point, feature) = nearest_point_triangle(a[n], *b);
        consider([a[n], point], 1 + n as u8, feature == Feature::Face);
        let (point, feature) = nearest_point_triangle(b[n], *a);
        consider([point, b[n]], 4 + n as u8, feature == Feature::Face);
    }
    for i in 0..3 {
        for j in 0..3 {
            let (points, at) = nearest_segments([a[i], a[(i + 1) % 3]], [b[j], b[(j + 1) % 3]]);
            let is_interior = at.iter().all(|t| *t > 0.0 && *t < 1.0);
            consider(points, (7 + 3 * i + j) as u8, is_interior);
        }
    }
    let (distance, points, features) = best;
    let normal = if distance > min_distance {
        Some((points[0] - points[1]) / distance)
    } else {
        separating_direction(a, b)
    };
    found.retain(|one| one.features != features);
    match normal {
        Some(normal) => found.insert(0, Nearest { points, normal, features }),
        None => found.clear(),
    }
}

/// Returns the unit vector along which the first triangle is farthest beyond the second, among the normals of faces and
/// the cross products of edges.
fn separating_direction(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<DVec3> {
    let edges = |x: &[DVec3; 3]| [x[1] - x[0], x[2] - x[1], x[0] - x[2]];
    let (e, f) = (edges(a), edges(b));
    let crosses = e.iter().flat_map(|e| f.iter().map(|f| e.cross(*f)));
    let faces = [e[0].cross(e[1]), f[0].cross(f[1])];
    let mut best: Option<(f64, DVec3)> = None;
    for direction in faces.into_iter().chain(crosses).filter_map(DVec3::try_normalize) {
        for normal in [direction, -direction] {
            let low = a.iter().map(|x| normal.dot(*x - b[0])).fold(f64::INFINITY, f64::min);
            let high = b.iter().map(|y| normal.dot(*y - b[0])).fold(f64::NEG_INFINITY, f64::max);
            if best.is_none_or(|(gap, _)| low - high > gap) {
                best = Some((low - high, normal));
            }
        }
    }
    best.map(|(_, normal)| normal)
}

/// Returns the nearest points of two segments, and their parameters on these (Ericson, Real-Time Collision Detection, 5.1.9).
fn nearest_segments([p, q]: [DVec3; 2], [r, s]: [DVec3; 2]) -> ([DVec3; 2], [f64; 2]) {
    let (d, e, between) = (q - p, s - r, p - r);
    let (dd, ee, f) = (d.dot(d), e.dot(e), e.dot(between));
    let share = |x: f64, y: f64| if y > 0.0 { (x / y).clamp(0.0, 1.0) } else { 0.0 };
    let (c, de) = (d.dot(between), d.dot(e));
    let mut t = share(de * f - c * ee, dd * ee - de * de);
    let mut u = if ee > 0.0 { (de * t + f) / ee } else { 0.0 };
    if !(0.0..=1.0).contains(&u) {
        u = u.clamp(0.0, 1.0);
        t = share(de * u - c, dd);
    }
    ([p + d * t, r + e * u], [t, u])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nearest_triangles(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Nearest> {
        let mut found = Vec::new();
        nearest_features(a, b, 0.0, &mut found);
        found.first().copied()
    }

    #[test]
    fn nearest_points_are_nearer_than_all_sampled_ones() {
        let mut state = 5_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / 2.0_f64.powi(31) - 0.5
        };
        for _ in 0..300 {
            let mut corner = |shift: f64| DVec3::new(random() + shift, random(), random());
            let (a, b) = ([(); 3].map(|()| corner(1.05)), [(); 3].map(|()| corner(0.0)));
            let Nearest { points: [x, y], normal, .. } = nearest_triangles(&a, &b).unwrap();
            let distance = x.distance(y);
            assert!((normal * distance - (x - y)).length() < 1e-12);
            let point = |c: &[DVec3; 3], i: i32, j: i32| {
                let (u, v) = (f64::from(i) / 6.0, f64::from(j) / 6.0);
                c[0] + (c[1] - c[0]) * u + (c[2] - c[0]) * v
            };
            let grid = || (0..=6).flat_map(|i| (0..=6 - i).map(move |j| (i, j)));
            for (i, j) in grid() {
                for (k, l) in grid() {
                    assert!(point(&a, i, j).distance(point(&b, k, l)) >= distance - 1e-12);
                }
            }
        }
    }

    #[test]
    fn triangles_that_almost_touch_are_parted_by_a_face_or_edges() {
        let b = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        let a = [DVec3::new(1.0, 1.0, 1e-13), DVec3::new(1.0, 1.0, 2.0), DVec3::new(2.0, 0.0, 2.0)];
        assert!((nearest_triangles(&a, &b).unwrap().normal - DVec3::Z).length() < 1e-12);
        assert_eq!(nearest_triangles(&[DVec3::ZERO; 3], &[DVec3::ZERO; 3]), None);
    }
}
