//! Errors of the page, its reports and its server.

use std::path::PathBuf;

use sscc::{Certificates, ReducedModel};

/// An error of the page: a model that it cannot show, or a request that it cannot answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// An error of the core, such as certificates of another model or a q of the wrong length.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// The page computes in single precision.
    #[error("the model has numbers beyond 1e30, the range of the page: choose another unit")]
    Range,
    /// A report has too much data.
    #[error(
        "the report would be larger than {} MiB, the limit of sscc view: give fewer frames",
        crate::MAX_REPORT_BYTES >> 20
    )]
    TooLarge,
    /// A request names data that do not exist, or has invalid values.
    #[error("{0}")]
    Request(String),
    /// A file is not a report.
    #[error("not a report of sscc: {0}")]
    NotAReport(String),
    /// A file of the npm package cannot be read.
    #[error(transparent)]
    File(#[from] sscc_io::IoError),
    /// A file that is not of the npm package.
    #[error("{}: not a file of the npm package sscc, which cargo xtask wasm builds", .0.display())]
    Package(PathBuf),
    /// A package of another version.
    #[error(
        "{}: the package has version {found}, sscc has {}: build it by cargo xtask wasm of the same version",
        .path.display(),
        env!("CARGO_PKG_VERSION")
    )]
    PackageVersion {
        /// The file with the version.
        path: PathBuf,
        /// The version.
        found: String,
    },
    /// A model or its certificates cannot be stored.
    #[error(transparent)]
    Format(#[from] sscc_io::FormatError),
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
    /// A picture cannot be encoded.
    #[cfg(feature = "picture")]
    #[error("the picture cannot be encoded: {0}")]
    Picture(#[from] png::EncodingError),
    /// The operating system has no random numbers for the token.
    #[cfg(feature = "server")]
    #[error("the operating system provides no random numbers: {0}")]
    Random(getrandom::Error),
}

/// Refuses certificates that the page cannot show as proofs of no collision.
///
/// # Errors
/// If they belong to another model or have a clearance.
pub(crate) fn check_certificates(model: &ReducedModel, certificates: &Certificates) -> Result<(), ViewError> {
    certificates.check_model(model)?;
    match certificates.clearance() {
        Some(_) => Err(sscc::Error::ClearanceCertificates.into()),
        None => Ok(()),
    }
}
