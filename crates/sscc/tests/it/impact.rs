//! Compares impacts of two moving triangles with exact arithmetic.

use glam::DVec3;
use num_traits::ToPrimitive;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use sscc::parts::impact_edge_edge;
use sscc::{Impact, MovingTriangle, impact_triangle_triangle};
use sscc_testing::cases;
use sscc_testing::first_contact;

/// Corners on a grid of integers: exact contacts of every kind, at times that need not be representable.
fn corners(size: i32) -> impl Strategy<Value = [DVec3; 3]> {
    prop::array::uniform3(
        prop::array::uniform3(-size..=size).prop_map(|p| DVec3::from_array(p.map(f64::from))),
    )
}

/// Returns any motion: rest, a translation, a motion to a segment or a point, a motion in a plane, or another one.
fn moving(size: i32) -> impl Strategy<Value = MovingTriangle> {
    (corners(size), corners(size), 0..8).prop_map(|(t0, t1, kind)| match kind {
        0 => MovingTriangle { t0, t1: t0 },
        1 => MovingTriangle { t0, t1: t0.map(|p| p + t1[0]) },
        2 => MovingTriangle { t0: [t0[0]; 3], t1: [t1[0]; 3] },
        3 => MovingTriangle { t0: [t0[0], t0[1], t0[1]], t1: [t1[0], t1[1], t1[1]] },
        4 => MovingTriangle { t0, t1: [t1[0]; 3] },
        5 => {
            let flat = |p: DVec3| DVec3::new(p.x, p.y, 0.0);
            MovingTriangle { t0: t0.map(flat), t1: t1.map(flat) }
        }
        _ => MovingTriangle { t0, t1 },
    })
}

fn agrees(x: &MovingTriangle, y: &MovingTriangle) -> Result<(), TestCaseError> {
    let exact = first_contact(x, y);
    for (x, y) in [(x, y), (y, x)] {
        let found = impact_triangle_triangle(x, y, Impact::TOLERANCE);
        // On this coarse grid triangles that do not touch have a clear distance.
        prop_assert_eq!(found.is_some(), exact.is_some(), "{:?} {:?}", found, exact);
        if let (Some(found), Some(exact)) = (found, &exact) {
            let (lower, upper) = (exact.lower().to_f64().unwrap(), exact.upper().to_f64().unwrap());
            prop_assert!(found <= upper, "{} after {}", found, upper);
            // Corners that approach along a curve of third order come within the tolerance long before the contact.
            prop_assert!(found > lower - 0.01, "{} long before {}", found, lower);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: cases(100), rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn impacts_are_those_of_exact_arithmetic(x in moving(3), y in moving(3)) {
        agrees(&x, &y)?;
    }

    /// On this grid there are far more contacts, nearly all of them degenerate.
    #[test]
    fn impacts_on_the_coarsest_grid(x in moving(1), y in moving(1)) {
        agrees(&x, &y)?;
    }
}

#[test]
fn exact_times_are_right() {
    let face = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
    let still = MovingTriangle { t0: face, t1: face };
    let falling = |from: f64, to: f64| {
        let at = |z: f64| DVec3::new(1.0, 1.0, z);
        MovingTriangle { t0: [at(from); 3], t1: [at(to); 3] }
    };
    let time =
        |from, to| first_contact(&still, &falling(from, to)).map(|root| root.lower().to_f64().unwrap());
    assert_eq!(time(2.0, -2.0), Some(0.5));
    assert!((time(1.0, -2.0).unwrap() - 1.0 / 3.0).abs() < 1e-14);
    assert_eq!(time(0.0, 1.0), Some(0.0));
    assert_eq!(time(1.0, 0.0), Some(1.0));
    assert_eq!(time(2.0, 1.0), None);
}

#[test]
fn edges_that_cross_meet() {
    let still = [[DVec3::NEG_X, DVec3::X]; 2];
    let falling =
        |depth: f64| [1.0, 1.0 - depth].map(|z| [DVec3::new(0.0, -1.0, z), DVec3::new(0.0, 1.0, z)]);
    for (a, b) in [(still, falling(2.0)), (falling(2.0), still)] {
        let t = impact_edge_edge(a, b, 1e-9).unwrap();
        assert!(t <= 0.5 && t > 0.5 - 1e-8, "{t}");
    }
    assert_eq!(impact_edge_edge(still, falling(0.999), 1e-9), None);
}
