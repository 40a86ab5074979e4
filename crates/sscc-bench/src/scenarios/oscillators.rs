//! Free oscillation of each mode with its natural frequency.

use std::f64::consts::TAU;

use sscc_tasks::CertifiedModel;

use crate::random::Random;

const SEED: u64 = 11;

/// Angular frequencies (1/s) and phases of all modes.
pub struct Oscillators {
    frequencies: Vec<f64>,
    phases: Vec<f64>,
}

impl Oscillators {
    /// Returns the oscillators of a model's modes, with random phases.
    pub fn of(model: &CertifiedModel) -> Self {
        Self::new(model.elasticity.stiffness().diagonal().map(|k| k.max(0.0).sqrt()).collect())
    }

    /// Returns oscillators of these angular frequencies (1/s), with random phases.
    pub fn new(frequencies: Vec<f64>) -> Self {
        let random = &mut Random(SEED);
        let phases = frequencies.iter().map(|_| TAU * random.uniform()).collect();
        Self { frequencies, phases }
    }

    /// Returns the frequency of the first mode (Hz).
    pub fn first_frequency(&self) -> f64 {
        self.frequencies[0] / TAU
    }

    /// Returns amplitudes at which all modes have the same largest speed, `1 / omega_k`.
    pub fn amplitudes_of_equal_speed(&self) -> Vec<f64> {
        self.frequencies.iter().map(|frequency| 1.0 / frequency).collect()
    }

    /// Returns `q_k = a_k cos(omega_k t + phase_k)` after a number of periods of the first mode.
    pub fn at(&self, amplitudes: &[f64], periods: f64) -> Vec<f64> {
        let time = TAU * periods / self.frequencies[0];
        let swing = |k: usize| amplitudes[k] * libm::cos(self.frequencies[k] * time + self.phases[k]);
        (0..amplitudes.len()).map(swing).collect()
    }
}
