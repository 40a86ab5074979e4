//! Steps at random q of a given displacement.

use crate::measure::Step;
use crate::sampling::scaled;

/// A continuous query goes from q to this multiple of it.
const ONWARD: f64 = 1.01;

/// Steps at a share (percent) of q of unit displacement.
pub fn displacement_steps(unit: &[Vec<f64>], share: f64) -> Vec<Step> {
    let at = |q: &[f64], factor: f64| vec![scaled(q, share / 100.0 * factor)];
    unit.iter().map(|q| Step { before: None, q_t0: at(q, 1.0), q_t1: at(q, ONWARD) }).collect()
}
