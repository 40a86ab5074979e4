//! Counter-examples to the paper's bounds as printed: models for which they exceed the true minimum.

#![allow(clippy::print_stdout)] // how often random pairs are counter-examples

use glam::DVec3;

use super::models::{ROOM, all_bounds};
use super::random::Random;
use super::true_minimum::OraclePair;
use crate::{Metric, Modes, ReducedModel, TriMesh};

/// Returns a pair by its corners and, for each corner, its modes.
fn pair(p: [[f64; 3]; 6], a: [&[[f64; 3]]; 6]) -> OraclePair {
    OraclePair {
        p: p.map(DVec3::from_array),
        a: a.map(|a| a.iter().map(|u| DVec3::from_array(*u)).collect()),
    }
}

fn model_of(pair: &OraclePair) -> ReducedModel {
    let mesh = TriMesh::new(pair.p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::new(pair.rank(), pair.a.concat()).unwrap();
    ReducedModel::with_metric(mesh, modes, Metric::identity(pair.rank())).unwrap()
}

/// Checks that our bounds and the paper's conservative ones are at most a minimum that the printed form exceeds.
fn check_counter_example(pair: &OraclePair, truth: f64, printed: f64, safe: f64) {
    assert!(printed > truth * 1.01, "printed {printed} is no counter-example: {truth}");
    assert!(safe <= truth * ROOM, "safe {safe} above {truth}");
    for (name, bound) in all_bounds(&model_of(pair), &mut Random::new(1)) {
        assert!(bound <= truth * ROOM, "{name} {bound} above {truth}");
    }
}

const LOW: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Triangles one above the other, the upper one 1 higher.
const STACKED: [[f64; 3]; 6] = [LOW[0], LOW[1], LOW[2], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];

/// Tests Eq. 10 with the squared `R_c` on random pairs with strongly varying modes.
#[test]
fn eq10_with_squares_is_not_conservative() {
    let mut found = 0;
    for seed in 0..400 {
        let random = &mut Random::new(seed + 40_000);
        let (rank, size) = (3 + random.below(4), random.power(-2.0, 0.0));
        let pair = OraclePair {
            p: std::array::from_fn(|v| random.vector() * size + if v < 3 { DVec3::ZERO } else { DVec3::X }),
            a: std::array::from_fn(|_| (0..rank).map(|_| random.vector()).collect()),
        };
        let Some(truth) = pair.true_minimum(6, random) else { continue };
        assert!(pair.eq10_safe() <= truth * ROOM, "seed {seed}");
        if pair.eq10_printed() > truth * 1.01 && pair.eq10_without_rest_test() <= truth {
            check_counter_example(&pair, truth, pair.eq10_printed(), pair.eq10_safe());
            found += 1;
        }
    }
    println!("{found} of 400 pairs break Eq. 10 with squares");
    assert!(found > 0);
}

/// Two modes, each of which closes the gap of 1 alone at `|q| = 1`: together they need only `1 / sqrt 2`.
#[test]
fn single_modes_are_not_conservative() {
    let down: &[[f64; 3]] = &[[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]];
    let still: &[[f64; 3]] = &[[0.0; 3]; 2];
    let boxes = pair(STACKED, [still, still, still, down, down, down]);
    let truth = 0.5_f64.sqrt();
    check_counter_example(&boxes, truth, boxes.box_estimate_printed(), boxes.box_estimate_safe());
    assert!((boxes.box_estimate_safe() - truth).abs() < 1e-12);

    let small = |[x, y, z]: [f64; 3]| [x * 1e-3, y * 1e-3, z];
    let line = pair(STACKED.map(small), [still, still, still, down, down, down]);
    check_counter_example(&line, truth, line.line_estimate_printed(), line.line_estimate_safe());
}

/// An edge pierces a face at rest: no feature contact at 0, but the truth is 0.
#[test]
fn feature_contacts_miss_a_piercing_at_rest() {
    let axes: &[[f64; 3]] = &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let still: &[[f64; 3]] = &[[0.0; 3]; 3];
    let through = [[0.3, 0.3, -1.0], [0.3, 0.3, 1.0], [3.0, 3.0, 0.0]];
    let p = [LOW[0], LOW[1], LOW[2], through[0], through[1], through[2]];
    let pair = pair(p, [still, still, still, axes, axes, axes]);
    let truth = pair.true_minimum(4, &mut Random::new(1)).unwrap();
    assert_eq!(truth, 0.0);
    check_counter_example(&pair, truth, pair.eq10_without_rest_test(), pair.eq10_safe());
    println!("feature contacts alone: {}", pair.eq10_without_rest_test());
}

/// There is one mode: the mean modes only slide, but the corners come down. The last of `min(3, r)` singular values certifies
/// (nearly) infinity.
#[test]
fn the_last_of_too_few_singular_values_is_not_conservative() {
    let still: &[[f64; 3]] = &[[0.0; 3]];
    let down: &[[f64; 3]] = &[[0.1, 0.0, -2.0]];
    let up: &[[f64; 3]] = &[[0.1, 0.0, 2.0]];
    let level: &[[f64; 3]] = &[[0.1, 0.0, 0.0]];
    let pair = pair(STACKED, [still, still, still, down, up, level]);
    let truth = pair.true_minimum(8, &mut Random::new(1)).unwrap();
    assert!(truth < 1.0, "{truth}");
    assert!(pair.eq10_last_singular_value() > 1e4, "{}", pair.eq10_last_singular_value());
    check_counter_example(&pair, truth, pair.eq10_last_singular_value(), pair.eq10_safe());
}
