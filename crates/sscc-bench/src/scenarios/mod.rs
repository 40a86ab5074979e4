//! The scenarios.

mod amplitudes;
mod displaced;
mod growth;
mod growth_plot;
mod kinetic;
mod list;
mod simulated;

pub use amplitudes::{AmplitudesModel, amplitudes_models};
pub use growth::{Exponents, GROWTH_RANK, GROWTH_SIZES, GrowthRecord, GrowthSize};
pub use kinetic::{KineticBench, KineticRecord};
pub use list::{ListedScenario, Scenario};
pub use simulated::{SCENE_STEPS, SceneMeasurement, measure_scene};
