//! The outcomes of commands, and the exit codes of the program.

/// The outcome of a command that ran to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The command is done, and has no finding.
    Done,
    /// `check` found a collision (or a pair nearer than the clearance), `sweep` a weight or a combination that is not
    /// free, `audit` a violation (with `--exact`, a proof that does not hold), or `resolve` no free q for some row.
    Finding,
}

/// The exit code of [`Outcome::Finding`].
pub const EXIT_FINDING: u8 = 1;

/// The exit code of an error.
pub const EXIT_ERROR: u8 = 2;

/// The exit code that shells report for an interrupted program.
pub const EXIT_INTERRUPTED: u8 = 130;
