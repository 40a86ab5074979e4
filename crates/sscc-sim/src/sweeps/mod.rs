//! Sweeps of a model from files: the first weight of each mode at which its shape touches itself.

mod sweep_model;
mod sweep_range;
mod sweep_row;

pub use sweep_model::{SweepRequest, sweep_model};
pub use sweep_range::SweepRange;
pub use sweep_row::{SweepRow, sweep_table};
