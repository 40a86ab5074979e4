//! Why a proof, or a file, is refused.

use std::fmt;

/// One line: the place and the cause.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A file cannot be read, or is of another model: nothing was checked.
    Input(String),
    /// The proof does not hold.
    Proof(String),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(line) | Self::Proof(line) => f.write_str(line),
        }
    }
}

impl std::error::Error for Refusal {}

/// Refuses an input.
pub(crate) fn input<T>(line: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal::Input(line.into()))
}

/// Refuses a proof.
pub(crate) fn proof<T>(line: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal::Proof(line.into()))
}
