//! Benches of sscc: what queries cost, by every method and beside the peer parry3d.
//!
//! One process, one thread, the same q in the same order, the methods interleaved; each with its own cost of moving
//! vertices and refitting; all must list the same pairs. `docs/benchmarks.md` explains how. A scenario measures one model
//! after the other, and gives a record of each, which is one line of JSON.
//!
//! Long work is followed and cancelled by a [`sscc_sim::Watch`]. Nothing is printed.

mod error;
mod measure;
mod methods;
mod paper;
mod plots;
mod progress;
mod random;
mod record;
mod sampling;
mod scenarios;
mod setup;

pub use error::Error;
pub use paper::PaperTable;
pub use plots::BenchPage;
pub use random::Random;
pub use record::{Means, Record};
pub use scenarios::{
    AmplitudesModel, Exponents, GROWTH_RANK, GROWTH_SIZES, GrowthRecord, GrowthSize, KineticBench,
    KineticRecord, ListedScenario, SCENE_STEPS, Scenario, SceneMeasurement, amplitudes_models, measure_scene,
};
pub use setup::Setup;
