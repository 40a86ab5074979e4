//! First contact of two triangles whose corners move along straight lines, in plain floating point: only for upper
//! bounds, which steer the search and never enter a radius.

use glam::DVec3;

/// Samples of each determinant along the way; roots closer together than this are missed.
const SAMPLES: usize = 24;

/// How far outside a feature a contact may seem to lie, in barycentric units.
const TOLERANCE: f64 = 1e-7;

/// The least t in (0, 1] at which a corner of one triangle meets the other, or two edges meet, if one is found.
/// `at(t)` gives the corners of both triangles.
pub(super) fn first_contact(at: impl Fn(f64) -> ([DVec3; 3], [DVec3; 3])) -> Option<f64> {
    let mut first = f64::INFINITY;
    let mut consider = |feature: &dyn Fn(f64) -> [DVec3; 4], inside: fn(&[DVec3; 4]) -> bool| {
        let volume = |t: f64| {
            let [a, b, c, d] = feature(t);
            (b - a).dot((c - a).cross(d - a))
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
                if root < first && inside(&feature(root)) {
                    first = root;
                    return;
                }
            }
            before = here;
        }
    };
    for v in 0..3 {
        consider(
            &|t| {
                let (x, y) = at(t);
                [x[v], y[0], y[1], y[2]]
            },
            vertex_in_face,
        );
        consider(
            &|t| {
                let (x, y) = at(t);
                [y[v], x[0], x[1], x[2]]
            },
            vertex_in_face,
        );
        for w in 0..3 {
            consider(
                &|t| {
                    let (x, y) = at(t);
                    [x[v], x[(v + 1) % 3], y[w], y[(w + 1) % 3]]
                },
                edges_cross,
            );
        }
    }
    first.is_finite().then_some(first)
}

/// The root between two ends of different sign.
fn bisect(mut a: f64, mut b: f64, negative_at_a: bool, f: &dyn Fn(f64) -> f64) -> f64 {
    for _ in 0..48 {
        let middle = 0.5 * (a + b);
        if (f(middle) < 0.0) == negative_at_a {
            a = middle;
        } else {
            b = middle;
        }
    }
    b
}

/// Whether v, in the plane of the triangle abc, lies in it.
fn vertex_in_face([v, a, b, c]: &[DVec3; 4]) -> bool {
    let normal = (*b - *a).cross(*c - *a);
    let area = normal.length_squared();
    let weight = |p: &DVec3, q: &DVec3| (*q - *p).cross(*v - *p).dot(normal) / area;
    [weight(a, b), weight(b, c), weight(c, a)].into_iter().all(|w| w >= -TOLERANCE)
}

/// Whether two edges ab and cd in one plane cross.
fn edges_cross([a, b, c, d]: &[DVec3; 4]) -> bool {
    let normal = (*b - *a).cross(*d - *c);
    let area = normal.length_squared();
    let s = (*c - *a).cross(*d - *c).dot(normal) / area;
    let t = (*c - *a).cross(*b - *a).dot(normal) / area;
    [s, 1.0 - s, t, 1.0 - t].into_iter().all(|w| w >= -TOLERANCE)
}
