//! Tests of all bounds: against a slow search for the true minimum, exact arithmetic, and the paper's own bounds.

mod clearance;
mod counter_examples;
mod lower_bounds;
mod models;
mod paper_bounds;
pub(super) mod random;
pub(super) mod rounding;
mod true_minimum;
