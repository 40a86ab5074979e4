//! Tests of steps.

mod divergence;
mod energy;
mod rolling;
mod sleep;
mod step_limiter;
