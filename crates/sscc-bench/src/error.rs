//! Errors of benches.

use sscc_sim::SimError;
use sscc_tasks::TaskError;

/// Error of a bench; its message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no scenario of this name.
    #[error("there is no scenario '{name}'; did you mean '{nearest}'? (sscc bench --list)")]
    NoScenario {
        /// The name.
        name: String,
        /// The nearest name of a scenario.
        nearest: &'static str,
    },
    /// The model lacks the certificates of the column `paper`.
    #[error("the model has no certificates as in the paper: add them with CertifiedModel::with_paper")]
    NoPaperCertificates,
    /// The scene has several models.
    #[error("the scene has {models} models: benches measure scenes of one model")]
    SeveralModels {
        /// Number of models.
        models: usize,
    },
    /// The scene has one step only.
    #[error("the scene has one step only: benches need at least two")]
    NoMotion,
    /// A query failed, or the work was cancelled.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// Error of a model or a file.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// Error of a scene or a simulation.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The data of the report cannot be written.
    #[error("the report cannot be written: {0}")]
    Page(#[from] serde_json::Error),
    /// A picture cannot be drawn.
    #[error(transparent)]
    View(#[from] sscc_view::ViewError),
    /// The thread of a simulation cannot be started.
    #[error("the thread of a simulation cannot be started: {0}")]
    Thread(#[from] rayon::ThreadPoolBuildError),
}
