//! First contacts at a known time.

use super::*;
use crate::bounds::tests::random::Random;

/// A vertex of one triangle meets the inside of the other, or two edges meet, wherever the triangles are.
#[test]
fn first_contacts_are_found_when_they_happen() {
    for case in 0..400 {
        let random = &mut Random::new(case);
        let normal = random.vector().normalize();
        let (along, across) = normal.any_orthonormal_pair();
        let middle = random.vector() * 3.0;
        let at = |x: f64, y: f64, z: f64| middle + along * x + across * y + normal * z;
        let first = 0.05 + 0.9 * random.uniform();
        let (i, j) = (random.below(3), random.below(3));
        let ([mut moving, mut still], is_vertex) = ([[DVec3::ZERO; 3]; 2], case % 2 == 0);
        if is_vertex {
            moving[i] = at(0.0, 0.0, first);
            moving[(i + 1) % 3] = at(0.5, 0.2, first + 1.0);
            moving[(i + 2) % 3] = at(-0.3, 0.4, first + 1.2);
            still[j] = at(1.0, 0.1, 0.0);
            still[(j + 1) % 3] = at(-0.6, 0.9, 0.0);
            still[(j + 2) % 3] = at(-0.4, -1.0, 0.0);
        } else {
            moving[i] = at(-1.0, 0.1, first);
            moving[(i + 1) % 3] = at(1.0, -0.1, first);
            moving[(i + 2) % 3] = at(0.1, 0.3, first + 1.0);
            still[j] = at(0.1, -1.0, 0.0);
            still[(j + 1) % 3] = at(-0.1, 1.0, 0.0);
            still[(j + 2) % 3] = at(0.3, 0.0, -1.0);
        }
        let is_first = random.below(2) == 0;
        let corners_at = |t: f64| {
            let moved = moving.map(|p| p - normal * t);
            if is_first { TwoTriangles { a: moved, b: still } } else { TwoTriangles { a: still, b: moved } }
        };
        let found = estimate_first_contact(corners_at);
        assert!(
            found.is_some_and(|found| (found - first).abs() < 1e-9),
            "case {case}: {found:?}, not {first}"
        );
    }
}

/// The determinant is exactly 0 at a sample, with either sign before it.
#[test]
fn contacts_at_a_sample_are_found() {
    let above = [DVec3::new(0.25, 0.25, 0.5), DVec3::new(0.25, 0.5, 1.5), DVec3::new(0.5, 0.25, 1.5)];
    for b in [[DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::ZERO, DVec3::Y, DVec3::X]] {
        let found = estimate_first_contact(|t| TwoTriangles { a: above.map(|p| p - DVec3::Z * t), b });
        assert!(found.is_some_and(|found| (found - 0.5).abs() < 1e-9), "{found:?}");
    }
}

/// Returns a triangle whose first corner is at this height above the inside of a triangle at height 0, and
/// lower than the others.
fn above(height: f64) -> TwoTriangles {
    let moving = [DVec3::new(0.25, 0.25, 0.0), DVec3::new(0.25, 0.5, 1.0), DVec3::new(0.5, 0.25, 1.0)];
    TwoTriangles { a: moving.map(|p| p + DVec3::Z * height), b: [DVec3::ZERO, DVec3::X, DVec3::Y] }
}

/// A corner that passes through the other triangle and returns meets it twice.
#[test]
fn the_first_of_two_contacts_is_found() {
    let found = estimate_first_contact(|t| above(5.0 * (t - 0.3) * (t - 0.6)));
    assert!(found.is_some_and(|found| (found - 0.3).abs() < 1e-9), "{found:?}");
}

/// All corners pass through the plane of the other triangle, beside it.
#[test]
fn triangles_that_pass_each_other_have_no_contact() {
    let beside = [DVec3::new(5.0, 0.0, 0.5), DVec3::new(6.0, 0.5, 0.5), DVec3::new(5.3, 1.0, 0.5)];
    let b = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let found = estimate_first_contact(|t| TwoTriangles { a: beside.map(|p| p - DVec3::Z * t), b });
    assert_eq!(found, None);
}

/// The distance is that of the lowest corner to the plane. It is small for a part of the time only.
#[test]
fn first_nearness_is_found_when_it_happens() {
    for (nearest, when) in [(0.1, 0.3), (0.15, 0.7), (0.0, 0.5)] {
        let corners_at = |t: f64| above(nearest + 4.0 * (t - when) * (t - when));
        let distance = nearest + 0.1;
        let expected = when - f64::sqrt(0.1 / 4.0);
        let found = estimate_first_nearness(corners_at, distance);
        assert!(found.is_some_and(|found| (found - expected).abs() < 1e-9), "{found:?}, not {expected}");
        assert_eq!(estimate_first_nearness(corners_at, 0.5 * nearest), None);
    }
}

/// A vertex is in a face where all of its weights are positive, and two edges cross where both meet inside;
/// corners count.
#[test]
fn features_meet_where_all_weights_are_positive() {
    let mut inside = [0; 2];
    for case in 0..1000 {
        let random = &mut Random::new(case);
        let size = random.power(-3.0, 3.0);
        let [p, q, r] = [(); 3].map(|()| random.vector() * size);
        let mut number = || 3.0 * random.uniform() - 1.0;
        let (u, v) = (number(), number());
        let certain = |weights: &[f64]| weights.iter().all(|w| w.abs() > 1e-3);
        let weights = [1.0 - u - v, u, v];
        if certain(&weights) {
            let expected = weights.iter().all(|w| *w > 0.0);
            let vertex = p * weights[0] + q * weights[1] + r * weights[2];
            assert_eq!(is_vertex_in_face(&[vertex, p, q, r]), expected, "case {case}: {weights:?}");
            inside[0] += usize::from(expected);
        }
        let weights = [u, 1.0 - u, v, 1.0 - v];
        if certain(&weights) {
            let expected = weights.iter().all(|w| *w > 0.0);
            let (along, across) = (q - p, r - p);
            let edges = [p - along * u, p + along * (1.0 - u), p - across * v, p + across * (1.0 - v)];
            assert_eq!(is_edge_crossing_edge(&edges), expected, "case {case}: {weights:?}");
            inside[1] += usize::from(expected);
        }
        assert!(is_vertex_in_face(&[p, p, q, r]) && is_edge_crossing_edge(&[p, q, p, r]), "case {case}");
    }
    assert!(inside.iter().all(|count| *count > 20), "{inside:?}");
}
