//! What can be wrong with a file: always one line, with the file, the place and the cause.

use std::fmt;
use std::path::{Path, PathBuf};

/// A file that could not be read, understood or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// No file of that name.
    #[error("{}: not found", line(path))]
    NotFound {
        /// The file.
        path: PathBuf,
    },
    /// A directory, a device or a pipe in place of a file.
    #[error("{}: is {found}, a file was expected", line(path))]
    NotAFile {
        /// What was named.
        path: PathBuf,
        /// What it is.
        found: &'static str,
    },
    /// The system refused.
    #[error("{}: cannot be {action}: {cause}", line(path))]
    System {
        /// The file.
        path: PathBuf,
        /// "read" or "written".
        action: &'static str,
        /// What the system said.
        cause: std::io::Error,
    },
    /// The bytes of the file are not what they should be.
    #[error("{}: {error}", line(path))]
    Format {
        /// The file.
        path: PathBuf,
        /// The place in it and the cause.
        error: FormatError,
    },
    /// A file name whose ending is not known.
    #[error("{}: unknown kind of {what} file; supported: {supported}", line(path))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What was to be read: "mesh", "modes", ...
        what: &'static str,
        /// The endings that are read.
        supported: &'static str,
    },
    /// Files that do not go together, or values that no file can hold.
    #[error("{}: {cause}", line(path))]
    Request {
        /// The file at fault.
        path: PathBuf,
        /// What is wrong, and what to do.
        cause: String,
    },
}

/// What is wrong with the bytes of one file, and where. It does not know the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}{cause}")]
pub struct FormatError {
    place: Place,
    cause: String,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The file as a whole.
    Whole,
    /// A line of a text file, counted from 1.
    Line(usize),
    /// An offset in bytes from the beginning.
    Byte(usize),
    /// A tensor of a container.
    Tensor(String),
    /// A text entry of a container.
    Key(String),
    /// A part with a name of its own: of a glTF file (`meshes[2]`), or of an archive.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line(line) => write!(f, "line {line}: "),
            Self::Byte(byte) => write!(f, "byte {byte}: "),
            Self::Tensor(name) => write!(f, "tensor {}: ", quoted(name)),
            Self::Key(name) => write!(f, "metadata {}: ", quoted(name)),
            Self::Part(name) => write!(f, "{}: ", cut(name, 80)),
        }
    }
}

impl FormatError {
    pub(crate) fn new(place: Place, cause: impl Into<String>) -> Self {
        Self { place, cause: cause.into() }
    }

    /// Something wrong with the file as a whole.
    pub(crate) fn whole(cause: impl Into<String>) -> Self {
        Self::new(Place::Whole, cause)
    }

    /// Something wrong with a line, counted from 1.
    pub(crate) fn line(line: usize, cause: impl Into<String>) -> Self {
        Self::new(Place::Line(line), cause)
    }

    /// Something wrong with a named part.
    pub(crate) fn part(name: impl Into<String>, cause: impl Into<String>) -> Self {
        Self::new(Place::Part(name.into()), cause)
    }

    /// Where it is.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// What it is, and where useful what to do about it.
    pub fn cause(&self) -> &str {
        &self.cause
    }

    /// The same, with the name of the file.
    pub(crate) fn of(self, path: &Path) -> IoError {
        IoError::Format { path: path.to_owned(), error: self }
    }
}

/// The core's own refusals say which vertex, face or mode; that is place enough.
impl From<sscc::Error> for FormatError {
    fn from(error: sscc::Error) -> Self {
        Self::whole(error.to_string())
    }
}

/// A mesh as a whole is refused: its elements are named by their numbers.
impl From<sscc_solid::SolidError> for FormatError {
    fn from(error: sscc_solid::SolidError) -> Self {
        Self::whole(error.to_string())
    }
}

/// A path on one line, whatever characters are in it.
fn line(path: &Path) -> String {
    let shown = path.to_string_lossy();
    if shown.chars().any(char::is_control) { shown.escape_debug().to_string() } else { shown.into_owned() }
}

/// Text from a file for use in a message: quoted, on one line, and cut when long.
pub(crate) fn quoted(text: &str) -> String {
    format!("'{}'", cut(text, 40))
}

/// Text that may hold some of a file's, on one line and cut when long.
pub(crate) fn cut(text: &str, longest: usize) -> String {
    let mut line = String::new();
    for c in text.chars().take(longest) {
        match c {
            '\'' | '"' => line.push(c), // our own quotes stay as they are
            _ => line.extend(c.escape_debug()),
        }
    }
    if text.chars().nth(longest).is_some() {
        line += "...";
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_one_line() {
        let error = FormatError::line(3, format!("{} is bad", quoted("a\nb"))).of(Path::new("dir/x\ny.obj"));
        assert_eq!(error.to_string(), r"dir/x\ny.obj: line 3: 'a\nb' is bad");
        let error = FormatError::part("array 'a\n\"'", "is bad");
        assert_eq!(error.to_string(), r#"array 'a\n"': is bad"#);
        assert_eq!(quoted(&"x".repeat(50)), format!("'{}...'", "x".repeat(40)));
    }
}
