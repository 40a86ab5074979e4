//! Sweeps of a model from files: the first weight of each mode at which its shape touches itself, or all intervals in which it
//! collides; combinations of two modes.

mod combinations;
mod interval_row;
mod sweep_model;
mod sweep_range;
mod sweep_row;

pub use combinations::{CombinationRow, Combinations, combination_table, sweep_model_combinations};
pub use interval_row::{Interval, IntervalRow, interval_table};
pub use sweep_model::{SweepRequest, sweep_model, sweep_model_intervals};
pub use sweep_range::SweepRange;
pub use sweep_row::{SweepRow, sweep_table};
