//! How a caller follows a simulation: its progress stage by stage, and remarks on the way.

use sscc::Progress;

use crate::SimError;

/// The stage of a long job.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Stage {
    /// Embeds a surface in a lattice, or reads a solid.
    Solid,
    /// Computes modes.
    Modes,
    /// Computes certificates.
    Certificates,
    /// Simulates; progress counts steps.
    Steps {
        /// Simulated seconds of one step.
        step: f64,
    },
    /// Measures the traditional method on some of the states.
    Comparison,
}

/// [`Progress`] of work that has several stages. Cancels all of them.
pub trait Watch: Progress {
    /// A stage begins: from now on progress is reported of it.
    fn begin(&self, stage: Stage);

    /// A remark that is no error, in one line, such as that a damaged file of the cache was made anew.
    fn note(&self, note: &str);
}

/// Stops here when `progress` says so.
pub(crate) fn check_cancelled(progress: &dyn Progress) -> Result<(), SimError> {
    if progress.is_cancelled() { Err(sscc::Error::Cancelled.into()) } else { Ok(()) }
}

/// Neither shows nor stops anything.
impl Watch for () {
    fn begin(&self, _stage: Stage) {}

    fn note(&self, _note: &str) {}
}
