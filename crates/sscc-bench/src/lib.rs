//! Benches of sscc: the cost of queries by every method, compared with the peer parry3d.
//!
//! All methods run in one process and on one thread, interleaved, for the same q in the same order. The time of each
//! method includes its own moving of vertices and refitting. All exact methods must list the same pairs.
//! `docs/benchmarks.md` explains the measurement. A scenario measures one model after the other, and returns a record
//! of each, which is one line of JSON.
//!
//! A [`sscc_tasks::Watch`] follows and cancels long work. The crate prints nothing.

pub mod demo;
mod error;
mod figures;
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
pub use figures::{Figure, FigureRecord};
pub use paper::PaperTable;
pub use plots::BenchPage;
pub use random::Random;
pub use record::{Means, Record};
pub use scenarios::{
    BenchModel, Exponents, GROWTH_RANK, GROWTH_SIZES, GrowthRecord, GrowthSize, KineticBench, KineticRecord,
    ListedScenario, ModelsScenario, SCENE_STEPS, Scenario, SceneMeasurement, measure_scene, plot_norms,
    plot_scenes,
};
pub use setup::Setup;
