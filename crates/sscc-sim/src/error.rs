//! Errors of models, scenes and simulations: one line each, with the file, the place and the cause.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use sscc_dynamics::DynamicsError;
use sscc_io::IoError;
use sscc_modes::ModesError;
use sscc_solid::{MaterialError, SolidError};

/// The result of a function of this crate.
pub(crate) type Result<T, E = SimError> = std::result::Result<T, E>;

/// Something that could not be read, made, simulated or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The core refused, or the caller's progress cancelled.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// No modes could be made.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// A solid or its material was refused.
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// A world of bodies was refused.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A file could not be read, understood or written.
    #[error(transparent)]
    File(#[from] IoError),
    /// The system refused.
    #[error("{place}: {cause}")]
    System {
        /// The file or folder.
        place: String,
        /// The system's error.
        cause: io::Error,
    },
    /// A scene file is wrong at a line.
    #[error("{}: line {line}: {cause}", path.display())]
    Scene {
        /// The scene file.
        path: PathBuf,
        /// The line, counted from 1.
        line: usize,
        /// What is wrong.
        cause: String,
    },
    /// A request that cannot be fulfilled.
    #[error("{place}: {cause}")]
    Refused {
        /// The file, the key or the part at fault.
        place: String,
        /// What is wrong, and the way out.
        cause: String,
    },
    /// Another error, with its place.
    #[error("{place}: {error}")]
    At {
        /// The file, the scene or the part.
        place: String,
        /// The error there.
        error: Box<SimError>,
    },
    /// A motion left the range of numbers.
    #[error(
        "step {step} ({time:.4} s): the motion of body {body} (counted from 0) diverges (energy {energy:.3e} J){cause}; \
         take more steps in a second, or more damping"
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
        /// The error of the world, after a colon; empty where the energy alone shows it.
        cause: String,
    },
    /// A simulation was cancelled; its states until then are kept.
    #[error("interrupted after {steps} steps; the same command goes on from there")]
    Interrupted {
        /// States in the folder.
        steps: usize,
    },
    /// A simulation ended early; its states until then are kept.
    #[error("{failure}; what was simulated until then is in {}{}", folder.display(), in_parentheses(unwritten))]
    EndedEarly {
        /// Why it ended.
        failure: Box<SimError>,
        /// The folder of its files.
        folder: PathBuf,
        /// Why some file was not written.
        unwritten: Option<Box<SimError>>,
    },
}

impl SimError {
    /// Refuses a request: the part at fault, and what is wrong with it.
    pub fn refused(place: impl Display, cause: impl Into<String>) -> Self {
        Self::Refused { place: place.to_string(), cause: cause.into() }
    }

    pub(crate) fn system(path: &Path, cause: io::Error) -> Self {
        Self::System { place: path.display().to_string(), cause }
    }

    /// This error with its place; a cancellation stays as it is.
    pub fn at(self, place: impl Into<String>) -> Self {
        if self.is_cancelled() { self } else { Self::At { place: place.into(), error: Box::new(self) } }
    }

    /// Whether the caller's progress cancelled.
    pub fn is_cancelled(&self) -> bool {
        match self {
            Self::Core(error)
            | Self::Modes(ModesError::Core(error))
            | Self::Dynamics(DynamicsError::Core(error)) => *error == sscc::Error::Cancelled,
            Self::Interrupted { .. } => true,
            _ => false,
        }
    }

    /// The error of a file, where that is the cause.
    pub fn file(&self) -> Option<&IoError> {
        match self {
            Self::File(error) => Some(error),
            Self::At { error, .. } => error.file(),
            _ => None,
        }
    }

    /// Whether the system refused.
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

/// Adds the place to errors; a cancellation stays as it is.
pub(crate) trait At<T> {
    fn at(self, place: impl FnOnce() -> String) -> Result<T, SimError>;

    /// As [`At::at`]; errors of readers and writers name their file already.
    fn in_file(self, path: &Path) -> Result<T, SimError>;
}

impl<T, E: Into<SimError>> At<T> for Result<T, E> {
    fn at(self, place: impl FnOnce() -> String) -> Result<T, SimError> {
        self.map_err(|error| error.into().at(place()))
    }

    fn in_file(self, path: &Path) -> Result<T, SimError> {
        match self.map_err(Into::into) {
            Err(SimError::File(error)) => Err(error.into()),
            found => found.at(|| path.display().to_string()),
        }
    }
}

/// The system's refusals, with the file.
pub(crate) trait InSystem<T> {
    fn system(self, path: &Path) -> Result<T, SimError>;
}

impl<T> InSystem<T> for io::Result<T> {
    fn system(self, path: &Path) -> Result<T, SimError> {
        self.map_err(|cause| SimError::system(path, cause))
    }
}
