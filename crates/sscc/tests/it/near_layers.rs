//! Sweeps of two layers that nearly touch everywhere and rotate together: few steps suffice, and the work is limited if the
//! rounding of positions is nearly as large as the gap.

use std::f64::consts::TAU;

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{Method, Modes, Query, ReducedModel, Sweep, SweepOutcome, TriMesh};

use crate::sweep::check;

/// The number of squares of a layer along each side.
const SIDE: u32 = 4;

/// The number of triangles of both layers.
const TRIANGLES: usize = 4 * (SIDE * SIDE) as usize;

/// Returns two layers with a gap, which one mode bends to waves together. The mode also brings them closer, by `closing` times the
/// gap.
fn layers(gap: f64, wave: impl Fn(f64, f64) -> DVec3, closing: f64) -> ReducedModel {
    let row = SIDE + 1;
    let (mut positions, mut displacements, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for layer in 0..2 {
        let first = positions.len() as u32;
        for i in 0..row * row {
            let [x, y] = [i % row, i / row].map(|i| f64::from(i) / f64::from(SIDE));
            positions.push(DVec3::new(x, y, f64::from(layer) * gap));
            displacements.push(wave(x, y) - DVec3::Z * (f64::from(layer) * closing * gap));
        }
        for i in (0..SIDE * SIDE).map(|i| first + i / SIDE * row + i % SIDE) {
            faces.extend([[i, i + 1, i + row], [i + 1, i + row + 1, i + row]]);
        }
    }
    assert_eq!(faces.len(), TRIANGLES);
    let mesh = TriMesh::new(positions, faces).unwrap();
    ReducedModel::new(mesh, Modes::new(1, displacements).unwrap()).unwrap()
}

fn upwards(x: f64, y: f64) -> DVec3 {
    DVec3::Z * (TAU * (0.8 * x + 0.3 * y)).sin()
}

fn askew(x: f64, y: f64) -> DVec3 {
    DVec3::new(0.3 * (4.0 * y).cos(), 0.2 * (3.0 * x).sin(), (5.0 * x + 2.0 * y).sin())
}

/// Returns the sweep of the only mode from 0 to 1, checked by brute force, and its number of triangle tests and steps.
fn sweep(model: &ReducedModel) -> (Sweep, u64) {
    let mut query = Query::without_certificates(model, Scope::of(model), Method::BdTree).unwrap();
    let sweep = query.sweep(&[0.0], 0, 1.0).unwrap();
    let statistics = query.statistics();
    assert!(statistics.complete && statistics.opened > 0 && statistics.box_tests > 0, "{statistics:?}");
    let mut oracle = Query::without_certificates(model, Scope::of(model), Method::BruteForce).unwrap();
    check(&sweep, model, &[0.0], &mut oracle, 60);
    (sweep, statistics.triangle_tests)
}

/// Each pair of opposite triangles rotates by about one radian at a distance of the gap.
#[test]
fn layers_that_nearly_touch_are_free_after_few_steps() {
    for gap in [1e-3, 1e-6, 1e-9, 1e-12] {
        for model in [layers(gap, upwards, 0.0), layers(gap, askew, 0.0)] {
            let (sweep, tests) = sweep(&model);
            assert_eq!((sweep.outcome, sweep.first_free), (SweepOutcome::Free, Some(1.0)), "{gap}");
            assert!(tests < 128 * TRIANGLES as u64, "{gap}: {tests}");
        }
    }
}

/// The layers would touch everywhere at 2/3.
#[test]
fn layers_that_meet_are_bracketed_after_limited_work() {
    for gap in [1e-3, 1e-9, 1e-12] {
        for model in [layers(gap, upwards, 1.5), layers(gap, askew, 1.5)] {
            let (sweep, tests) = sweep(&model);
            // The smallest gap is within the tolerance of continuous queries from the start.
            let least = if gap > 1e-11 { 0.6 } else { 0.3 };
            let is_close = |free: f64| free > least && free <= 2.0 / 3.0;
            assert!(sweep.first_free.is_some_and(is_close), "{gap}: {sweep:?}");
            assert!(matches!(sweep.outcome, SweepOutcome::Hit | SweepOutcome::WithinTolerance), "{sweep:?}");
            assert!(tests < 1024 * TRIANGLES as u64, "{gap}: {tests}");
        }
    }
}

#[test]
fn gaps_of_a_few_roundings_take_limited_work() {
    for gap in [2e-14, 8e-15, 4e-15, 1e-15, 2e-16] {
        for closing in [0.0, 1.5] {
            for model in [layers(gap, upwards, closing), layers(gap, askew, closing)] {
                let (sweep, tests) = sweep(&model);
                assert!(tests < 4096 * TRIANGLES as u64, "{gap}, {closing}: {tests} {sweep:?}");
            }
        }
    }
}
