//! Errors of tasks on files: one line each, which names the file, the place and the cause.

use std::io;
use std::path::Path;

use sscc_io::{IoError, Message, Setting};
use sscc_modes::ModesError;
use sscc_solid::{MaterialError, SolidError};

/// The result of a function of this crate.
pub(crate) type Result<T, E = TaskError> = std::result::Result<T, E>;

/// Error of a model, a request or a file; its message is one line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// Error of the core, or cancellation by the caller's progress.
    #[error(transparent)]
    Core(#[from] sscc::Error),
    /// Error of the computation of modes.
    #[error(transparent)]
    Modes(#[from] ModesError),
    /// Error of a solid or its material.
    #[error(transparent)]
    Solid(#[from] SolidError),
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
    /// A request that cannot be fulfilled.
    #[error("{place}: {cause}")]
    Refused {
        /// The file, the key or the part at fault.
        place: Message,
        /// The error, and the way out.
        cause: Message,
    },
    /// Another error, with its place.
    #[error("{place}: {error}")]
    At {
        /// The file or the part.
        place: Message,
        /// The error there.
        error: Box<TaskError>,
    },
}

impl TaskError {
    /// Returns a [`TaskError::Refused`] with the part at fault and the cause.
    pub fn refused(place: impl Into<Message>, cause: impl Into<Message>) -> Self {
        Self::Refused { place: place.into(), cause: cause.into() }
    }

    /// Returns a [`TaskError::System`] with the file.
    pub fn system(path: &Path, cause: io::Error) -> Self {
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
            Self::Core(error) | Self::Modes(ModesError::Core(error)) => *error == sscc::Error::Cancelled,
            _ => false,
        }
    }

    /// Returns the error of a file if that is the cause.
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

impl From<MaterialError> for TaskError {
    fn from(error: MaterialError) -> Self {
        Self::Solid(error.into())
    }
}

/// Adds a place to errors; cancellations stay unchanged.
pub(crate) trait At<T> {
    /// Adds a place.
    fn at<P: Into<Message>>(self, place: impl FnOnce() -> P) -> Result<T, TaskError>;

    /// Adds a file as the place, except to errors of readers and writers, which name their file already.
    fn in_file(self, path: &Path) -> Result<T, TaskError>;
}

impl<T, E: Into<TaskError>> At<T> for Result<T, E> {
    fn at<P: Into<Message>>(self, place: impl FnOnce() -> P) -> Result<T, TaskError> {
        self.map_err(|error| error.into().at(place()))
    }

    fn in_file(self, path: &Path) -> Result<T, TaskError> {
        match self.map_err(Into::into) {
            Err(TaskError::File(error)) => Err(error.into()),
            found => found.at(|| path.display()),
        }
    }
}
