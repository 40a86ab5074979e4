//! Scenarios of the benches.

mod amplitudes;
mod displacement;
mod growth;
mod growth_plot;
mod kinetic;
mod list;
mod scene;

pub use amplitudes::{AmplitudesModel, amplitudes_models};
pub use growth::{Exponents, GROWTH_RANK, GROWTH_SIZES, GrowthRecord, GrowthSize};
pub use kinetic::{KineticBench, KineticRecord};
pub use list::{ListedScenario, Scenario};
pub use scene::{SCENE_STEPS, SceneMeasurement, measure_scene};
