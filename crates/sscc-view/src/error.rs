//! What cannot be shown.

/// Why a model cannot be shown, or a request not be answered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// Of the core: other certificates, a q that is none.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// The page computes in single precision.
    #[error("the model's numbers are beyond what a page can show (1e30): choose another unit")]
    Range,
    /// What was asked for does not exist or does not fit.
    #[error("{0}")]
    Request(String),
    /// A file that is shown as a report is none.
    #[error("it is no report of sscc: {0}")]
    NoReport(String),
    /// The system refused.
    #[error(transparent)]
    System(#[from] std::io::Error),
    /// A model of a simulation.
    #[error("{name}: {error}")]
    Model {
        /// What it is called.
        name: String,
        /// Why it cannot be shown.
        error: Box<ViewError>,
    },
    /// What cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A picture that cannot be encoded.
    #[cfg(feature = "picture")]
    #[error("the picture cannot be encoded: {0}")]
    Picture(#[from] png::EncodingError),
    /// No random numbers for the token.
    #[cfg(feature = "server")]
    #[error("the system gives no random numbers: {0}")]
    Random(getrandom::Error),
}
