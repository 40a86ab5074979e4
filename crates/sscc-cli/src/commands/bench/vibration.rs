//! Free vibrations, until there are forces: each mode swings with its natural frequency.

use super::case::Case;
use super::random::Random;
use super::sample::{directions, half_diagonal, largest_displacement, scaled};

/// Periods of the first mode in a scene, and steps in each.
const PERIODS: usize = 5;
const STEPS_PER_PERIOD: usize = 120;

/// Steps of a scene.
pub const SCENE_STEPS: usize = PERIODS * STEPS_PER_PERIOD;

const SEED: u64 = 11;

/// States of the first body whose largest displacement sets the amplitude.
const LOOKED_AT: usize = 60;

/// For each body `SCENE_STEPS + 1` states q: `z_k(t) = a_k cos(omega_k t + phase)`, the amplitudes those of the first of
/// the random [`directions`], phases of each body its own. Of the first body some vertex is displaced by `share` percent
/// of half the diagonal of the box, none by more, in the states that are looked at.
pub fn states(case: &Case, objects: usize, share: f64) -> Vec<Vec<Vec<f64>>> {
    let amplitudes = directions(&case.model, 1).remove(0);
    let first = case.frequencies.first().copied().unwrap_or(1.0);
    let step = std::f64::consts::TAU / (first * STEPS_PER_PERIOD as f64);
    let mut random = Random(SEED);
    let mut body = || -> Vec<Vec<f64>> {
        let phases: Vec<f64> = amplitudes.iter().map(|_| std::f64::consts::TAU * random.uniform()).collect();
        let state = |i: usize| -> Vec<f64> {
            let time = i as f64 * step;
            let swing = |k: usize| amplitudes[k] * libm::cos(case.frequencies[k] * time + phases[k]);
            (0..amplitudes.len()).map(swing).collect()
        };
        (0..=SCENE_STEPS).map(state).collect()
    };
    let mut bodies: Vec<Vec<Vec<f64>>> = (0..objects).map(|_| body()).collect();
    let looked_at = bodies[0].iter().step_by(SCENE_STEPS / LOOKED_AT);
    let largest = looked_at.map(|q| largest_displacement(&case.model, q)).fold(0.0, f64::max);
    let factor = share / 100.0 * half_diagonal(&case.model) / largest;
    bodies.iter_mut().flatten().for_each(|q| *q = scaled(q, factor));
    bodies
}
