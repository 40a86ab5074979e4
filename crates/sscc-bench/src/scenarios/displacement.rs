//! Steps at q of a given displacement.

use crate::measure::Step;
use crate::sampling::scaled;

/// A continuous query is from q to this multiple of q.
const END_FACTOR: f64 = 1.01;

/// Returns steps at a multiple of the given q of unit displacement; `share` is the factor in percent.
pub fn displacement_steps(unit: &[Vec<f64>], share: f64) -> Vec<Step> {
    let at = |q: &[f64], factor: f64| vec![scaled(q, share / 100.0 * factor)];
    unit.iter().map(|q| Step { before: None, q_t0: at(q, 1.0), q_t1: at(q, END_FACTOR) }).collect()
}
