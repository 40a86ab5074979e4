//! Errors of scenes and simulations: one line each, which names the file, the place and the cause.

use std::io;
use std::path::{Path, PathBuf};

use sscc_dynamics::DynamicsError;
use sscc_io::{IoError, Message};
use sscc_modes::ModesError;
use sscc_tasks::TaskError;

/// The result of a function of this crate.
pub(crate) type Result<T, E = SimError> = std::result::Result<T, E>;

/// Error of a scene or a simulation; its message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// Error of a model, a request or a file, or cancellation by the caller's progress.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// Error of a world of bodies.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A scene file has an error in a line.
    #[error("{}: line {line}: {cause}", path.display())]
    Scene {
        /// The scene file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// The error.
        cause: String,
    },
    /// Another error, with its place.
    #[error("{place}: {error}")]
    At {
        /// The scene or the part.
        place: Message,
        /// The error there.
        error: Box<SimError>,
    },
    /// A motion diverged.
    #[error(
        "step {step} ({time:.4} s): the motion of body {body} (counted from 0) diverges (energy {energy:.3e} J){cause}; \
         use more steps per second, or more damping"
    )]
    Diverged {
        /// The step.
        step: u64,
        /// Its time (s).
        time: f64,
        /// The body that diverged first, from 0.
        body: usize,
        /// Its energy (J).
        energy: f64,
        /// The error of the world, after a colon; empty if the energy alone shows it.
        cause: String,
    },
    /// A simulation was cancelled. Its states up to the end are kept.
    #[error("interrupted after {steps} steps; the same command continues from there")]
    Interrupted {
        /// States in the folder.
        steps: usize,
    },
    /// A simulation ended early. Its states up to the end are kept.
    #[error("{failure}; the states until then are in {}{}", folder.display(), in_parentheses(unwritten))]
    EndedEarly {
        /// Cause of the end.
        failure: Box<SimError>,
        /// The folder of its files.
        folder: PathBuf,
        /// Error of a file that was not written.
        unwritten: Option<Box<SimError>>,
    },
    /// A simulation is complete, but the measurement of the traditional method after it failed or was cancelled.
    #[error(
        "{failure}: the traditional method was not measured; the simulation is complete, and its files are in {}{}; the same command measures \
         again",
        folder.display(),
        in_parentheses(unwritten)
    )]
    Unmeasured {
        /// Cause of the end.
        failure: Box<SimError>,
        /// The folder of its files.
        folder: PathBuf,
        /// Error of a file that was not written.
        unwritten: Option<Box<SimError>>,
    },
}

impl SimError {
    /// Returns a [`TaskError::Refused`] with the part at fault and the cause.
    pub(crate) fn refused(place: impl Into<Message>, cause: impl Into<Message>) -> Self {
        TaskError::refused(place, cause).into()
    }

    /// Returns the message with its settings as data.
    pub fn message(&self) -> Message {
        match self {
            Self::Task(error) => error.message(),
            Self::At { place, error } => place.clone() + ": " + error.message(),
            error => error.to_string().into(),
        }
    }

    /// Whether the error is a cancellation by the caller's progress.
    pub fn is_cancelled(&self) -> bool {
        match self {
            Self::Task(error) => error.is_cancelled(),
            Self::Dynamics(DynamicsError::Core(error)) => *error == sscc::Error::Cancelled,
            Self::Interrupted { .. } => true,
            Self::Unmeasured { failure, .. } => failure.is_cancelled(),
            _ => false,
        }
    }

    /// Returns the error of a model, a request or a file if that is the cause.
    pub fn task(&self) -> Option<&TaskError> {
        match self {
            Self::Task(error) => Some(error),
            Self::At { error, .. } => error.task(),
            _ => None,
        }
    }
}

fn in_parentheses(error: &Option<Box<SimError>>) -> String {
    error.as_ref().map(|error| format!(" ({error})")).unwrap_or_default()
}

impl From<sscc::Error> for SimError {
    fn from(error: sscc::Error) -> Self {
        Self::Task(error.into())
    }
}

impl From<ModesError> for SimError {
    fn from(error: ModesError) -> Self {
        Self::Task(error.into())
    }
}

impl From<IoError> for SimError {
    fn from(error: IoError) -> Self {
        Self::Task(error.into())
    }
}

/// Adds a place to errors; cancellations stay unchanged.
pub(crate) trait At<T> {
    fn at<P: Into<Message>>(self, place: impl FnOnce() -> P) -> Result<T>;
}

impl<T, E: Into<SimError>> At<T> for Result<T, E> {
    fn at<P: Into<Message>>(self, place: impl FnOnce() -> P) -> Result<T> {
        self.map_err(Into::into).map_err(|error| {
            if error.is_cancelled() {
                error
            } else {
                SimError::At { place: place().into(), error: Box::new(error) }
            }
        })
    }
}

/// Adds the file to errors of the operating system.
pub(crate) trait InSystem<T> {
    fn system(self, path: &Path) -> Result<T>;
}

impl<T> InSystem<T> for io::Result<T> {
    fn system(self, path: &Path) -> Result<T> {
        self.map_err(|cause| TaskError::system(path, cause).into())
    }
}
