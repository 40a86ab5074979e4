//! Estimates the first contact of two triangles whose corners move linearly, in plain floating point. Only upper bounds
//! use it.

use glam::DVec3;

use crate::geometry::{TwoTriangles, nearest_to_origin};

/// Number of samples of each determinant over t in [0, 1]. Two roots between the same two samples are missed.
const SAMPLES: usize = 24;

/// Largest distance outside a feature at which a contact counts, in barycentric units.
const TOLERANCE: f64 = 1e-7;

/// Returns the smallest t in (0, 1] at which a corner of one triangle meets the other, or two edges meet, if one is found.
pub(super) fn estimate_first_contact(corners_at: impl Fn(f64) -> TwoTriangles) -> Option<f64> {
    let mut first = f64::INFINITY;
    let mut consider = |feature: &dyn Fn(f64) -> [DVec3; 4], is_contact: fn(&[DVec3; 4]) -> bool| {
        let volume = |t: f64| {
            let [p, q, r, s] = feature(t);
            (q - p).dot((r - p).cross(s - p))
        };
        let mut before = (0.0, volume(0.0));
        for i in 1..=SAMPLES {
            let t = i as f64 / SAMPLES as f64;
            if before.0 >= first {
                return;
            }
            let here = (t, volume(t));
            if (before.1 < 0.0) != (here.1 < 0.0) {
                let root = bisect(before.0, here.0, before.1 < 0.0, &volume);
                if root < first && is_contact(&feature(root)) {
                    first = root;
                    return;
                }
            }
            before = here;
        }
    };
    for i in 0..3 {
        consider(
            &|t| {
                let TwoTriangles { a, b } = corners_at(t);
                [a[i], b[0], b[1], b[2]]
            },
            is_vertex_in_face,
        );
        consider(
            &|t| {
                let TwoTriangles { a, b } = corners_at(t);
                [b[i], a[0], a[1], a[2]]
            },
            is_vertex_in_face,
        );
        for j in 0..3 {
            consider(
                &|t| {
                    let TwoTriangles { a, b } = corners_at(t);
                    [a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]]
                },
                is_edge_crossing_edge,
            );
        }
    }
    first.is_finite().then_some(first)
}

/// Returns the smallest t in (0, 1] at which two triangles are as near as a distance, if one is found.
pub(super) fn estimate_first_nearness(
    corners_at: impl Fn(f64) -> TwoTriangles,
    distance: f64,
) -> Option<f64> {
    let excess = |t: f64| nearest_to_origin(&corners_at(t).differences()).point.length() - distance;
    let times = (0..=SAMPLES).map(|i| i as f64 / SAMPLES as f64);
    let (before, near) = times.clone().zip(times.skip(1)).find(|(_, t)| excess(*t) < 0.0)?;
    Some(bisect(before, near, false, &excess))
}

/// Returns a root between two numbers at which f has different signs.
fn bisect(mut lower: f64, mut upper: f64, is_negative_at_lower: bool, f: &dyn Fn(f64) -> f64) -> f64 {
    for _ in 0..48 {
        let middle = 0.5 * (lower + upper);
        if (f(middle) < 0.0) == is_negative_at_lower {
            lower = middle;
        } else {
            upper = middle;
        }
    }
    upper
}

/// Whether a vertex v in the plane of the triangle p, q, r lies in it.
fn is_vertex_in_face([v, p, q, r]: &[DVec3; 4]) -> bool {
    let normal = (*q - *p).cross(*r - *p);
    let area = normal.length_squared();
    let weight = |start: &DVec3, end: &DVec3| (*end - *start).cross(*v - *start).dot(normal) / area;
    [weight(p, q), weight(q, r), weight(r, p)].into_iter().all(|w| w >= -TOLERANCE)
}

/// Whether two edges pq and rs in one plane cross.
fn is_edge_crossing_edge([p, q, r, s]: &[DVec3; 4]) -> bool {
    let normal = (*q - *p).cross(*s - *r);
    let area = normal.length_squared();
    let u = (*r - *p).cross(*s - *r).dot(normal) / area;
    let v = (*r - *p).cross(*q - *p).dot(normal) / area;
    [u, 1.0 - u, v, 1.0 - v].into_iter().all(|w| w >= -TOLERANCE)
}

#[cfg(test)]
mod tests;
