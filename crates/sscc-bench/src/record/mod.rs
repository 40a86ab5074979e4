//! Records of what was measured, as JSON has them.

mod means;
mod model_record;

pub use means::Means;
pub use model_record::{Record, SceneTotals};
