//! Standard output: results only. Standard error: everything else. No panic when nobody reads them.

use std::fmt::Display;
use std::io::{self, BufWriter, ErrorKind, IsTerminal, StdoutLock, Write};
use std::path::Path;

use anyhow::Context;
use serde::Serialize;
pub use sscc_sim::text::{counted, duration, grouped, length, one_line};

/// Standard output, by lines: at once when someone watches, else in blocks.
///
/// When its reader leaves (`sscc ... | head`), what follows is dropped without an error: files are still to be written,
/// and the exit code is that of the answers. A command that only prints asks [`Output::is_closed`], and stops.
pub struct Output {
    stdout: BufWriter<StdoutLock<'static>>,
    watched: bool,
    closed: bool,
}

impl Output {
    /// Takes standard output.
    pub fn new() -> Self {
        let stdout = io::stdout().lock();
        Self { watched: stdout.is_terminal(), stdout: BufWriter::new(stdout), closed: false }
    }

    /// Whether standard output is a terminal.
    pub fn is_watched(&self) -> bool {
        self.watched
    }

    /// Whether the reader of standard output has left, as far as is known from what was written.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Writes one line of text.
    pub fn line(&mut self, text: impl Display) -> anyhow::Result<()> {
        if self.closed {
            return Ok(());
        }
        let written = writeln!(self.stdout, "{text}");
        let written = written.and_then(|()| if self.watched { self.stdout.flush() } else { Ok(()) });
        self.note_closed(written)
    }

    /// Writes one JSON object on a line of its own. Numbers that are not finite become `null`.
    pub fn json(&mut self, object: &impl Serialize) -> anyhow::Result<()> {
        self.line(serde_json::to_string(object).context("the result is no JSON")?)
    }

    /// Writes what is still held back.
    pub fn flush(&mut self) -> anyhow::Result<()> {
        if self.closed {
            return Ok(());
        }
        let written = self.stdout.flush();
        self.note_closed(written)
    }

    /// Writes what is still held back, for the last time.
    pub fn finish(mut self) -> anyhow::Result<()> {
        self.flush()
    }

    fn note_closed(&mut self, written: io::Result<()>) -> anyhow::Result<()> {
        match written {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                self.closed = true;
                Ok(())
            }
            written => written.context("standard output cannot be written"),
        }
    }
}

/// A line on standard error. Nobody need read it: where it cannot be written, it is dropped.
pub fn say(text: impl Display) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// A remark beside the result, on standard error.
pub fn note(text: impl Display) {
    say(format_args!("note: {text}"));
}

/// The name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
