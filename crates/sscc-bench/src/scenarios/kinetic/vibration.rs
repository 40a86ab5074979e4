//! Free vibration of a body: each mode oscillates with its natural frequency.

use sscc::{Method, Progress, Query};
use sscc_tasks::CertifiedModel;

use crate::error::Error;
use crate::sampling::{directions, half_diagonal, largest_displacement, scaled};
use crate::scenarios::oscillators::Oscillators;

/// Number of periods of the first mode in the states for the choice of the amplitude.
const PERIODS: usize = 5;

/// Number of these states in each period.
const STATES_PER_PERIOD: usize = 12;

/// Number of states for the choice of the amplitude.
const STATES: usize = PERIODS * STATES_PER_PERIOD;

/// Number of these states that should collide.
const COLLIDING: usize = STATES / 8;

/// Range of the amplitude (percent).
const SHARES: [f64; 2] = [0.1, 100.0];

/// Number of bisections of the logarithm of the amplitude.
const BISECTIONS: usize = 10;

/// A body that vibrates: `q_k(t) = a_k cos(omega_k t + phase_k)`. The amplitudes are proportional to the first of the
/// random [`directions`].
pub struct Vibration {
    amplitudes: Vec<f64>,
    oscillators: Oscillators,
    /// Largest displacement of a vertex in percent of half the diagonal of the AABB, in the states for the choice of
    /// the amplitude.
    pub share: f64,
}

impl Vibration {
    /// Creates a vibration with an amplitude at which one in eight states collides.
    ///
    /// # Errors
    /// When `progress` cancels.
    pub fn new(model: &CertifiedModel, progress: &dyn Progress) -> Result<Self, Error> {
        let dir = directions(&model.model, 1)?.remove(0);
        let oscillators = Oscillators::of(model);
        let unit: Vec<Vec<f64>> =
            (0..STATES).map(|i| oscillators.at(&dir, i as f64 / STATES_PER_PERIOD as f64)).collect();
        let largest = unit.iter().map(|q| largest_displacement(&model.model, q)).fold(0.0, f64::max);
        let per_percent = half_diagonal(&model.model) / largest / 100.0;
        let query = Query::with_method(&model.model, &model.full.certificates, Method::Traditional)?;
        let [mut lower, mut upper] = SHARES;
        for _ in 0..BISECTIONS {
            let share = (lower * upper).sqrt();
            let states: Vec<Vec<f64>> = unit.iter().map(|q| scaled(q, share * per_percent)).collect();
            let answers = query.batch(&states, None, progress)?;
            let colliding = answers.iter().filter(|answer| !answer.pairs.is_empty()).count();
            if colliding < COLLIDING { lower = share } else { upper = share }
        }
        Ok(Self { amplitudes: scaled(&dir, upper * per_percent), oscillators, share: upper })
    }

    /// Returns the frequency of the first mode (Hz).
    pub fn first_frequency(&self) -> f64 {
        self.oscillators.first_frequency()
    }

    /// Returns q after a number of periods of the first mode.
    pub fn at(&self, periods: f64) -> Vec<f64> {
        self.oscillators.at(&self.amplitudes, periods)
    }
}
