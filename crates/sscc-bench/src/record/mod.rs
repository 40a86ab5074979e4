//! Records of measurements, as written to JSON.

mod means;
mod model_record;

pub use means::Means;
pub use model_record::{Record, SceneTotals};
