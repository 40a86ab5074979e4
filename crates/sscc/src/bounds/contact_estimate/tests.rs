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
