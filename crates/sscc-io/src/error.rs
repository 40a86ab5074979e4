//! Errors of reading and writing files: one line with the file, the place and the cause.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::Message;

/// Error of reading, parsing or writing a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// No file has this name.
    #[error("{}: not found", line(path))]
    NotFound {
        /// The file.
        path: PathBuf,
    },
    /// The path is a directory, a device or a pipe.
    #[error("{}: is {found}, a file was expected", line(path))]
    NotAFile {
        /// The path.
        path: PathBuf,
        /// Kind of the object at the path.
        found: &'static str,
    },
    /// The operating system reports an error.
    #[error("{}: cannot be {action}: {cause}", line(path))]
    System {
        /// The file.
        path: PathBuf,
        /// "read" or "written".
        action: &'static str,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// The content of the file is malformed.
    #[error("{}: {error}", line(path))]
    Format {
        /// The file.
        path: PathBuf,
        /// Place and cause of the error.
        error: FormatError,
    },
    /// The ending of the file name is not supported.
    #[error("{}: unknown kind of {what} file; supported: {supported}", line(path))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Kind of content: "mesh", "modes", ...
        what: &'static str,
        /// Supported endings.
        supported: &'static str,
    },
    /// Files that do not fit each other, values that the format cannot hold, or another request that cannot be met.
    #[error("{}: {cause}", line(path))]
    Request {
        /// The file to which the error belongs.
        path: PathBuf,
        /// Cause, and how to correct it.
        cause: Message,
    },
}

/// Error in the content of one file: place and cause, without the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}{cause}")]
pub struct FormatError {
    place: Place,
    cause: Message,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Place {
    /// The whole file.
    Whole,
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Offset in bytes from the beginning.
    Byte(usize),
    /// Cell of a grid, counted from 0.
    Cell(usize),
    /// Tensor of a container, by name.
    Tensor(String),
    /// Text entry of a container, by key.
    Key(String),
    /// Named part of a glTF file (`meshes[2]`) or of an archive.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => Ok(()),
            Self::Line(line) => write!(f, "line {line}: "),
            Self::Byte(byte) => write!(f, "byte {byte}: "),
            Self::Cell(cell) => write!(f, "cell {cell} (counted from 0): "),
            Self::Tensor(name) => write!(f, "tensor {}: ", quoted(name)),
            Self::Key(name) => write!(f, "metadata {}: ", quoted(name)),
            Self::Part(name) => write!(f, "{}: ", cut(name, 80)),
        }
    }
}

impl IoError {
    pub(crate) fn request(path: &Path, cause: impl Into<Message>) -> Self {
        Self::Request { path: path.to_owned(), cause: cause.into() }
    }

    /// Returns the message with its settings as data.
    pub fn message(&self) -> Message {
        match self {
            Self::Format { path, error } => {
                Message::from(format!("{}: {}", line(path), error.place)) + error.cause.clone()
            }
            Self::Request { path, cause } => Message::from(format!("{}: ", line(path))) + cause.clone(),
            error => error.to_string().into(),
        }
    }
}

impl FormatError {
    pub(crate) fn new(place: Place, cause: impl Into<Message>) -> Self {
        Self { place, cause: cause.into() }
    }

    /// Returns an error for the whole file.
    pub(crate) fn whole(cause: impl Into<Message>) -> Self {
        Self::new(Place::Whole, cause)
    }

    /// Returns an error for a line, counted from 1.
    pub(crate) fn line(line: usize, cause: impl Into<Message>) -> Self {
        Self::new(Place::Line(line), cause)
    }

    /// Returns an error for a named part.
    pub(crate) fn part(name: impl Into<String>, cause: impl Into<Message>) -> Self {
        Self::new(Place::Part(name.into()), cause)
    }

    /// Returns the place of the error.
    pub fn place(&self) -> &Place {
        &self.place
    }

    /// Returns the cause, with advice where there is one.
    pub fn cause(&self) -> &Message {
        &self.cause
    }

    /// Adds the name of the file.
    pub(crate) fn of(self, path: &Path) -> IoError {
        IoError::Format { path: path.to_owned(), error: self }
    }
}

/// Errors of `sscc` name the vertex, face or mode; the place is the whole file.
impl From<sscc::Error> for FormatError {
    fn from(error: sscc::Error) -> Self {
        Self::whole(error.to_string())
    }
}

/// Errors of `sscc-solid` name elements by their numbers; the place is the whole file.
impl From<sscc_solid::SolidError> for FormatError {
    fn from(error: sscc_solid::SolidError) -> Self {
        Self::whole(error.to_string())
    }
}

/// Returns a path on one line, with control characters escaped.
fn line(path: &Path) -> String {
    let shown = path.to_string_lossy();
    if shown.chars().any(char::is_control) { shown.escape_debug().to_string() } else { shown.into_owned() }
}

/// Returns the name of a file, without its folder, on one line and truncated.
pub(crate) fn shown_name(path: &Path) -> String {
    cut(&path.file_name().unwrap_or_default().to_string_lossy(), 80)
}

/// Returns text from a file for a message: quoted, on one line, truncated.
pub(crate) fn quoted(text: &str) -> String {
    format!("'{}'", cut(text, 40))
}

/// Returns text that may contain content of a file, on one line and truncated.
pub(crate) fn cut(text: &str, longest: usize) -> String {
    let mut line = String::new();
    for c in text.chars().take(longest) {
        match c {
            '\'' | '"' => line.push(c), // quotes of the message are not escaped
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
        assert_eq!(shown_name(Path::new("dir/x\ny.obj")), r"x\ny.obj");
        assert_eq!(quoted(&"x".repeat(50)), format!("'{}...'", "x".repeat(40)));
    }
}
