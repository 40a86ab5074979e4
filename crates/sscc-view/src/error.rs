//! Errors of the page, its reports and its server.

/// An error of the page: a model that it cannot show, or a request that it cannot answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// An error of the core, such as certificates of another model or a q of the wrong length.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// The page computes in single precision.
    #[error("the model's numbers are beyond what a page can show (1e30): choose another unit")]
    Range,
    /// A request names data that do not exist, or has invalid values.
    #[error("{0}")]
    Request(String),
    /// A file that is shown as a report is none.
    #[error("it is no report of sscc: {0}")]
    NoReport(String),
    /// An error of the operating system.
    #[error(transparent)]
    System(#[from] std::io::Error),
    /// An error in one model of a simulation.
    #[error("{name}: {error}")]
    Model {
        /// Name of the model.
        name: String,
        /// The error.
        error: Box<ViewError>,
    },
    /// Data cannot be written as JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// A picture that cannot be encoded.
    #[cfg(feature = "picture")]
    #[error("the picture cannot be encoded: {0}")]
    Picture(#[from] png::EncodingError),
    /// The operating system has no random numbers for the token.
    #[cfg(feature = "server")]
    #[error("the system gives no random numbers: {0}")]
    Random(getrandom::Error),
}
