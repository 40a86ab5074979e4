//! Errors of benches.

use sscc_sim::SimError;

/// A bench that could not be set up or measured.
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
    #[error("the model has no certificates as in the paper")]
    NoPaperCertificates,
    /// The scene has several models.
    #[error("the scene has {models} models; scenes of one model can be measured")]
    SeveralModels {
        /// Number of models.
        models: usize,
    },
    /// The scene is over at once.
    #[error("a scene of one step has nothing to measure")]
    NoMotion,
    /// A query failed, or the work was cancelled.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// A model or a simulation could not be made.
    #[error(transparent)]
    Sim(#[from] SimError),
    /// The numbers of the page could not be written.
    #[error("the page cannot be made: {0}")]
    Page(#[from] serde_json::Error),
    /// The thread of a simulation could not be started.
    #[error("no thread can be started: {0}")]
    Thread(#[from] rayon::ThreadPoolBuildError),
}
