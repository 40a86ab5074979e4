//! Callbacks by which a caller follows long work: stages, progress and notes.

use sscc::{CancelToken, Progress};
use sscc_io::Setting;

use crate::TaskError;

/// Stage of long work.
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
    /// Reads frames of a mesh.
    Reading,
    /// Searches for collisions in meshes.
    Detection,
}

/// [`Progress`] of work that has several stages. One cancellation ends all of them.
pub trait Watch: Progress {
    /// Called when a stage begins. Later progress belongs to this stage.
    fn begin(&self, stage: Stage);

    /// Receives a note: one line that is not an error, for example that a damaged file of the cache was computed again.
    fn note(&self, note: &str);

    /// Receives a line about work that begins, for example the energy of a body. By default it is dropped.
    fn inform(&self, _line: &str) {}

    /// Receives a warning: one line about input that violates a format, and its interpretation. By default it is a note.
    fn warn(&self, warning: &str) {
        self.note(warning);
    }

    /// Returns the caller's name of a setting, for notes.
    fn name(&self, setting: Setting) -> String {
        setting.name().into()
    }
}

/// Checks whether `progress` cancels.
///
/// # Errors
/// [`sscc::Error::Cancelled`] if it does.
pub fn check_cancelled(progress: &dyn Progress) -> Result<(), TaskError> {
    if progress.is_cancelled() { Err(sscc::Error::Cancelled.into()) } else { Ok(()) }
}

/// Ignores all calls and never cancels.
impl Watch for () {
    fn begin(&self, _stage: Stage) {}

    fn note(&self, _note: &str) {}
}

/// Progress that forwards cancellation and ignores reports: a batch counts its own q.
pub(crate) struct CancelledBy<'a>(pub(crate) &'a dyn Progress);

impl Progress for CancelledBy<'_> {
    fn report(&self, _done: usize, _total: usize) {}

    fn cancel_token(&self) -> Option<&CancelToken> {
        self.0.cancel_token()
    }
}
