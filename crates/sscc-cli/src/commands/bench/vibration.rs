//! Free vibrations, until there are forces: each mode swings with its natural frequency.

use std::f64::consts::TAU;

use anyhow::Result;
use sscc::{Method, Query};

use super::random::Random;
use super::sample::{directions, half_diagonal, largest_displacement, scaled};
use crate::interrupt::Interrupt;
use sscc_sim::CertifiedModel;

/// Periods of the first mode in a scene, and steps in each.
const PERIODS: usize = 5;
const STEPS_PER_PERIOD: usize = 120;

/// Steps of a scene.
pub const SCENE_STEPS: usize = PERIODS * STEPS_PER_PERIOD;

const SEED: u64 = 11;

/// States of the first body that are looked at, and how many of them shall collide.
const LOOKED_AT: usize = 60;
const COLLIDING: usize = LOOKED_AT / 8;

/// Between these shares (percent) the amplitude is searched, by so many bisections of its logarithm.
const SHARES: [f64; 2] = [0.1, 100.0];
const BISECTIONS: usize = 10;

/// One body: `z_k(t) = a_k cos(omega_k t + phase)`, the amplitudes in proportion to the first of the random
/// [`directions`].
pub struct Swing {
    amplitudes: Vec<f64>,
    frequencies: Vec<f64>,
    phases: Vec<f64>,
}

impl Swing {
    fn new(case: &CertifiedModel, random: &mut Random) -> Self {
        let amplitudes = directions(&case.model, 1).remove(0);
        let phases = amplitudes.iter().map(|_| TAU * random.uniform()).collect();
        let stiffness = case.elasticity.stiffness();
        let frequencies = stiffness.diagonal().map(|x| x.max(0.0).sqrt()).collect();
        Self { amplitudes, frequencies, phases }
    }

    /// Angular frequency of the first mode (1/s).
    pub fn first_frequency(&self) -> f64 {
        self.frequencies[0]
    }

    /// q after so many periods of the first mode.
    pub fn at(&self, periods: f64) -> Vec<f64> {
        let time = TAU * periods / self.frequencies[0];
        let swing = |k: usize| self.amplitudes[k] * libm::cos(self.frequencies[k] * time + self.phases[k]);
        (0..self.amplitudes.len()).map(swing).collect()
    }

    /// The states of a scene, one after the other, and one more.
    pub fn scene(&self) -> Vec<Vec<f64>> {
        (0..=SCENE_STEPS).map(|i| self.at(i as f64 / STEPS_PER_PERIOD as f64)).collect()
    }
}

/// What swings, and how far: the largest displacement of a vertex of the first body in percent of half the diagonal of
/// the box, in the states that are looked at.
pub struct Vibration {
    pub bodies: Vec<Swing>,
    pub share: f64,
}

impl Vibration {
    /// Of bodies with phases of their own, so large that one in eight states of the first body collides.
    pub fn new(case: &CertifiedModel, objects: usize) -> Result<Self> {
        let mut random = Random(SEED);
        let mut bodies: Vec<Swing> = (0..objects).map(|_| Swing::new(case, &mut random)).collect();
        let first = bodies[0].scene();
        let largest = |q: &Vec<f64>| largest_displacement(&case.model, q);
        let farthest = looked_at(&first).map(largest).fold(0.0, f64::max);
        let per_percent = half_diagonal(&case.model) / farthest / 100.0;
        let query = Query::with_method(&case.model, &case.full.certificates, Method::Traditional)?;
        let [mut lower, mut upper] = SHARES;
        for _ in 0..BISECTIONS {
            let share = (lower * upper).sqrt();
            let states: Vec<Vec<f64>> = looked_at(&first).map(|q| scaled(q, share * per_percent)).collect();
            let answers = query.batch(&states, None, &Interrupt)?;
            let colliding = answers.iter().filter(|answer| !answer.pairs.is_empty()).count();
            if colliding < COLLIDING { lower = share } else { upper = share }
        }
        for body in &mut bodies {
            body.amplitudes = scaled(&body.amplitudes, upper * per_percent);
        }
        Ok(Self { bodies, share: upper })
    }
}

fn looked_at(body: &[Vec<f64>]) -> impl Iterator<Item = &Vec<f64>> {
    body.iter().step_by(SCENE_STEPS / LOOKED_AT).take(LOOKED_AT)
}
