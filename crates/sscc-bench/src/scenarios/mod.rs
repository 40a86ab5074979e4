//! Scenarios of the benches.

mod amplitudes;
mod displacement;
mod growth;
mod growth_plot;
mod kinetic;
mod list;
mod mixed;
mod models;
mod norms;
mod oscillators;
mod scene;

pub use growth::{Exponents, GROWTH_RANK, GROWTH_SIZES, GrowthRecord, GrowthSize};
pub use kinetic::{KineticBench, KineticRecord};
pub use list::{ListedScenario, Scenario};
pub use models::{BenchModel, ModelsScenario};
pub use norms::plot_norms;
pub use scene::{SCENE_STEPS, SceneMeasurement, measure_scene, plot_scenes};
