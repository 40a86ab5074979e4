//! Writes results to standard output, and all other text to standard error. A closed pipe causes no panic.

use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, IsTerminal, StdoutLock, Write};
use std::path::Path;

use anyhow::Context;
use serde::Serialize;
pub use sscc_tasks::text::{counted, duration, file_name, grouped, length, one_line};

/// Standard output: line by line to a terminal, else in blocks.
///
/// When its reader closes the pipe (`sscc ... | head`), later lines are dropped without an error, because the command
/// may still have files to write. A command that only prints stops when [`Output::is_closed`]; its exit code is that of
/// the answers so far.
pub struct Output {
    stdout: BufWriter<StdoutLock<'static>>,
    is_terminal: bool,
    is_closed: bool,
}

impl Output {
    /// Locks standard output.
    pub fn new() -> Self {
        let stdout = io::stdout().lock();
        Self { is_terminal: stdout.is_terminal(), stdout: BufWriter::new(stdout), is_closed: false }
    }

    /// Whether a write has failed because the reader of standard output has closed the pipe.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Writes one line of text.
    pub fn line(&mut self, text: impl Display) -> anyhow::Result<()> {
        if self.is_closed {
            return Ok(());
        }
        let written = writeln!(self.stdout, "{text}");
        let written = written.and_then(|()| if self.is_terminal { self.stdout.flush() } else { Ok(()) });
        self.check_pipe(written)
    }

    /// Writes one JSON object on a line of its own. Numbers that are not finite become `null`.
    pub fn json(&mut self, object: &impl Serialize) -> anyhow::Result<()> {
        self.line(serde_json::to_string(object).context("the result cannot be written as JSON")?)
    }

    /// Writes buffered text.
    pub fn flush(&mut self) -> anyhow::Result<()> {
        if self.is_closed {
            return Ok(());
        }
        let written = self.stdout.flush();
        self.check_pipe(written)
    }

    /// Writes buffered text, and releases standard output.
    pub fn finish(mut self) -> anyhow::Result<()> {
        self.flush()
    }

    fn check_pipe(&mut self, written: io::Result<()>) -> anyhow::Result<()> {
        self.is_closed |= !is_written(written)?;
        Ok(())
    }
}

/// Returns whether text was written to standard output; false if the reader has closed the pipe. Other errors are returned.
pub fn is_written(written: io::Result<()>) -> anyhow::Result<bool> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(false),
        written => written.map(|()| true).context("standard output cannot be written"),
    }
}

/// Writes a line to standard error. If that fails, the line is dropped.
pub fn write_stderr(text: impl Display) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Writes a note about the result to standard error, on one line.
pub fn note(text: impl Display) {
    write_stderr(format_args!("note: {}", one_line(&text.to_string())));
}

/// Writes a warning about a file to standard error, on one line.
pub fn warn(path: &Path, warning: impl Display) {
    warn_line(format_args!("{}: {warning}", path.display()));
}

/// Writes a warning that names its file to standard error, on one line.
pub fn warn_line(warning: impl Display) {
    write_stderr(format_args!("warning: {}", one_line(&warning.to_string())));
}
