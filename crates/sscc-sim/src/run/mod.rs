//! Runs simulations of scenes: preparation, steps, the log of states, costs and a summary.

mod announcement;
mod clock;
mod finished;
mod history;
mod log;
mod prepared;
mod stepper;
mod steps;
mod summary;
mod traditional;
mod world;

pub use announcement::announcement;
pub use finished::FinishedRun;
pub use history::{BodyRecord, History, STEP_PARTS, StateLayout, StepRecord};
pub use log::StateLog;
pub use prepared::{PreparedModel, PreparedScene};
pub use steps::{RunOutcome, check_log_size, run};
pub use summary::{ModelSummary, Summary};
pub use traditional::{TraditionalCost, traditional_costs};
