//! Errors of models, scenes and simulations. Each is one line, which names the file, the place and the cause.

use std::io;
use std::path::{Path, PathBuf};

use sscc_dynamics::DynamicsError;
use sscc_io::{IoError, Message, Setting};
use sscc_modes::ModesError;
use sscc_solid::{MaterialError, SolidError};

/// The result of a function of this crate.
pub(crate) type Result<T, E = SimError> = std::result::Result<T, E>;

/// Error of a model, a scene, a simulation or a file; its message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// Error of the core, or cancellation by the caller's progress.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// Error of the computation of modes.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// Error of a solid or its material.
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// Error of a world of bodies.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// Error of a file: it cannot be read or written, or its content is invalid.
    #[error(transparent)]
    File(#[from] IoError),
    /// Error of the operating system.
    #[error("{place}: {cause}")]
    System {
        /// The file or folder.
        place: Message,
        /// The system's error.
        cause: io::Error,
    },
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
    /// A request that cannot be fulfilled.
    #[error("{place}: {cause}")]
    Refused {
        /// The file, the key or the part at fault.
        place: Message,
        /// The error, and a remedy.
        cause: Message,
    },
    /// Another error, with its place.
    #[error("{place}: {error}")]
    At {
        /// The file, the scene or the part.
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
}

impl SimError {
    /// Returns a [`SimError::Refused`] with the part at fault and the cause.
    pub fn refused(place: impl Into<Message>, cause: impl Into<Message>) -> Self {
        Self::Refused { place: place.into(), cause: cause.into() }
    }

    pub(crate) fn system(path: &Path, cause: io::Error) -> Self {
        Self::System { place: path.display().into(), cause }
    }

    /// Returns this error with a place. A cancellation is returned unchanged.
    pub fn at(self, place: impl Into<Message>) -> Self {
        if self.is_cancelled() { self } else { Self::At { place: place.into(), error: Box::new(self) } }
    }

    /// Returns the message with its settings as data.
    pub fn message(&self) -> Message {
        match self {
            Self::File(error) => error.message(),
            Self::Refused { place, cause } => place.clone() + ": " + cause.clone(),
            Self::At { place, error } => place.clone() + ": " + error.message(),
            Self::System { place, cause } => place.clone() + ": " + cause.to_string(),
            Self::Solid(SolidError::UnsupportedMaterial { .. }) => {
                Message::from(self.to_string()) + ", as in " + Setting::Material + " youngs=1e6,poisson=0.4"
            }
            error => error.to_string().into(),
        }
    }

    /// Whether the error is a cancellation by the caller's progress.
    pub fn is_cancelled(&self) -> bool {
        match self {
            Self::Core(error)
            | Self::Modes(ModesError::Core(error))
            | Self::Dynamics(DynamicsError::Core(error)) => *error == sscc::Error::Cancelled,
            Self::Interrupted { .. } => true,
            _ => false,
        }
    }

    /// Returns the error of a file if it is the cause.
    pub fn file(&self) -> Option<&IoError> {
        match self {
            Self::File(error) => Some(error),
            Self::At { error, .. } => error.file(),
            _ => None,
        }
    }

    /// Whether the cause is an error of the operating system.
    pub fn is_system(&self) -> bool {
        match self {
            Self::System { .. } => true,
            Self::At { error, .. } => error.is_system(),
            _ => false,
        }
    }
}

fn in_parentheses(error: &Option<Box<SimError>>) -> String {
    error.as_ref().map(|error| format!(" ({error})")).unwrap_or_default()
}

impl From<MaterialError> for SimError {
    fn from(error: MaterialError) -> Self {
        Self::Solid(error.into())
    }
}

/// Adds a place to errors; cancellations stay unchanged.
pub(crate) trait At<T> {
    /// Adds a place.
    fn at<P: Into<Message>>(self, place: impl FnOnce() -> P) -> Result<T, SimError>;

    /// Adds a file as the place, except to errors of readers and writers, which name their file already.
    fn in_file(self, path: &Path) -> Result<T, SimError>;
}

impl<T, E: Into<SimError>> At<T> for Result<T, E> {
    fn at<P: Into<Message>>(self, place: impl FnOnce() -> P) -> Result<T, SimError> {
        self.map_err(|error| error.into().at(place()))
    }

    fn in_file(self, path: &Path) -> Result<T, SimError> {
        match self.map_err(Into::into) {
            Err(SimError::File(error)) => Err(error.into()),
            found => found.at(|| path.display()),
        }
    }
}

/// Adds the file to errors of the operating system.
pub(crate) trait InSystem<T> {
    fn system(self, path: &Path) -> Result<T, SimError>;
}

impl<T> InSystem<T> for io::Result<T> {
    fn system(self, path: &Path) -> Result<T, SimError> {
        self.map_err(|cause| SimError::system(path, cause))
    }
}
