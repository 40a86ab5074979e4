//! Scenario `mixed`: the cost of queries while a body swings in all its modes at once.

use sscc_tasks::CertifiedModel;

use super::displacement::displacement_steps;
use super::oscillators::Oscillators;
use crate::error::Error;
use crate::measure::{Kinds, compare};
use crate::record::Record;
use crate::sampling::{half_diagonal, largest_displacement, scaled};
use crate::setup::Setup;

/// Largest `|z|` of the motions, over the root's radius.
const TIMES_ROOT: [f64; 3] = [2.0, 4.0, 8.0];

/// Duration of a motion, in periods of the first mode.
const PERIODS: f64 = 10.0;

/// Measures `samples` states of `q_k = a cos(omega_k t + phase_k) / omega_k`, evenly spread over ten periods of the first
/// mode. Returns one record for each of [`TIMES_ROOT`].
pub fn measure(
    name: &str,
    model: &CertifiedModel,
    setup: &Setup<'_>,
    samples: usize,
) -> Result<Vec<Record>, Error> {
    let norm = |q: &[f64]| model.full.certificates.norm(q);
    let unit = unit_motion(&Oscillators::of(model), norm, samples)?;
    let record = |times_root: f64| {
        setup.begin_measuring();
        let factor = times_root * model.full.certificates.root_radius();
        let steps = displacement_steps(&unit, 100.0 * factor);
        let comparison = compare(model, &steps, None, Kinds::Both, setup.watch)?;
        let displacement = |q: &Vec<f64>| largest_displacement(&model.model, &scaled(q, factor));
        let largest = unit.iter().map(displacement).fold(0.0, f64::max);
        let share = 100.0 * largest / half_diagonal(&model.model);
        let record = Record::new(format!("mixed/{name}"), share, model, &comparison, 1, None);
        Ok(Record { times_root: Some(times_root), ..record })
    };
    TIMES_ROOT.into_iter().map(record).collect()
}

/// Returns `samples` states of the motion, scaled so that their largest norm is 1.
fn unit_motion(
    oscillators: &Oscillators,
    norm: impl Fn(&[f64]) -> Result<f64, sscc::Error>,
    samples: usize,
) -> Result<Vec<Vec<f64>>, sscc::Error> {
    let amplitudes = oscillators.amplitudes_of_equal_speed();
    let at = |i: usize| oscillators.at(&amplitudes, PERIODS * i as f64 / samples as f64);
    let states: Vec<Vec<f64>> = (0..samples).map(at).collect();
    let largest = states.iter().try_fold(0.0_f64, |largest, q| Ok(largest.max(norm(q)?)))?;
    Ok(states.iter().map(|q| scaled(q, 1.0 / largest)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The states span ten periods of the first mode, all modes have the same largest speed, and the largest norm is 1.
    #[test]
    fn states_are_those_of_the_stated_motion() {
        let frequencies = [3.0, 7.5, 20.0];
        let norm =
            |q: &[f64]| q.iter().zip([1.0, 4.0, 9.0]).map(|(x, weight)| weight * x * x).sum::<f64>().sqrt();
        let states = unit_motion(&Oscillators::new(frequencies.to_vec()), |q| Ok(norm(q)), 20_000).unwrap();
        let largest = states.iter().map(|q| norm(q)).fold(0.0, f64::max);
        assert!((largest - 1.0).abs() < 1e-12, "{largest}");
        for (q, next) in states[..1000].iter().zip(&states[2000..]) {
            assert!((q[0] - next[0]).abs() < 1e-9, "the first mode is not periodic");
        }
        let largest_speed = |k: usize| frequencies[k] * states.iter().map(|q| q[k].abs()).fold(0.0, f64::max);
        let speeds = [0, 1, 2].map(largest_speed);
        assert!(speeds.iter().all(|speed| (speed / speeds[0] - 1.0).abs() < 1e-4), "{speeds:?}");
    }
}
