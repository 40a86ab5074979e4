//! `Refusal`: the reason why a proof or a file is refused, or why a check ended early.

use std::fmt;

/// A refusal, with a message of one line: the place and the cause.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// A file cannot be read, is damaged, or is of another model: nothing was checked.
    Input(String),
    /// The proof does not hold, or the certificates do not have the parts that they should have.
    Proof(String),
    /// The caller cancelled the check.
    Cancelled,
}

/// The result of reading or checking.
pub type Result<T> = std::result::Result<T, Refusal>;

/// Whether the caller cancels a check. Several threads call it often. Once true, it must stay true.
pub type IsCancelled<'a> = dyn Fn() -> bool + Sync + 'a;

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(line) | Self::Proof(line) => f.write_str(line),
            Self::Cancelled => f.write_str("interrupted"),
        }
    }
}

impl std::error::Error for Refusal {}

impl Refusal {
    /// Adds the name of the file before the message.
    pub(crate) fn of(mut self, name: &str) -> Self {
        if let Self::Input(line) | Self::Proof(line) = &mut self {
            line.insert_str(0, &format!("{name}: "));
        }
        self
    }
}

/// Ends a check that the caller cancels.
pub(crate) fn check_cancelled(is_cancelled: &IsCancelled<'_>) -> Result<()> {
    if is_cancelled() { Err(Refusal::Cancelled) } else { Ok(()) }
}

/// Returns the refusal of an input.
pub(crate) fn input<T>(line: impl Into<String>) -> Result<T> {
    Err(Refusal::Input(line.into()))
}

/// Refuses an input unless a condition holds.
pub(crate) fn require(holds: bool, line: &str) -> Result<()> {
    if holds { Ok(()) } else { input(line) }
}

/// Refuses certificates unless a condition holds.
pub(crate) fn claim(holds: bool, line: &str) -> Result<()> {
    if holds { Ok(()) } else { proof(line) }
}

/// Returns the refusal of a proof.
pub(crate) fn proof<T>(line: impl Into<String>) -> Result<T> {
    Err(Refusal::Proof(line.into()))
}
