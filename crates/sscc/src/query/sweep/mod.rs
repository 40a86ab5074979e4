//! Sweeps: a bracket of the first weight of a mode at which the shape touches itself, and the intervals of weights over which
//! it collides.

mod contact;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod sweep;
mod sweep_modes;
mod weight_intervals;
mod weight_line;
mod weight_sweep;
mod work;

pub use sweep::{Sweep, SweepOutcome};
pub use sweep_modes::ModeRange;
pub use weight_intervals::{WeightInterval, WeightIntervals, WeightSample, largest_depth};
