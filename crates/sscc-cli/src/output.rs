//! Standard output: results only. Standard error: everything else. No panic when nobody reads them.

use std::fmt::{Display, Write as _};
use std::io::{self, BufWriter, ErrorKind, IsTerminal, StdoutLock, Write};
use std::path::Path;

use anyhow::Context;
use serde::Serialize;

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

/// Text on one line, whatever is in it: errors name files, and files may have any name.
pub fn one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            let _ = write!(line, "{}", c.escape_debug());
        } else {
            line.push(c);
        }
    }
    line
}

/// A radius or a length for people: four digits, "unlimited" where it is infinite.
pub fn length(value: f64) -> String {
    match value {
        0.0 => "0".into(),
        v if v.is_infinite() => "unlimited".into(),
        v if (1e-3..1e6).contains(&v.abs()) => {
            let decimals = (3 - v.abs().log10().floor() as i32).clamp(0, 6) as usize;
            format!("{v:.decimals$}")
        }
        v => format!("{v:.3e}"),
    }
}

/// The name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// A number with its noun: "1 pair", "2 pairs".
pub fn counted(count: impl Into<u64>, noun: &str) -> String {
    match count.into() {
        1 => format!("1 {noun}"),
        n => format!("{} {noun}s", grouped(n)),
    }
}

/// A number in groups of three digits.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A time for people, from microseconds.
pub fn duration(microseconds: f64) -> String {
    match microseconds {
        t if t < 1.0 => format!("{:.0} ns", t * 1e3),
        t if t < 1e3 => format!("{t:.1} us"),
        t if t < 1e6 => format!("{:.2} ms", t / 1e3),
        t => format!("{:.2} s", t / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!([0, 999, 16_000, 1_234_567].map(grouped), ["0", "999", "16,000", "1,234,567"]);
        assert_eq!(counted(1_u32, "pair"), "1 pair");
        assert_eq!(counted(0_u32, "pair"), "0 pairs");
        assert_eq!(
            [0.0, f64::INFINITY, 0.012_345, 1234.56, 1e-9].map(length),
            ["0", "unlimited", "0.01235", "1235", "1.000e-9"]
        );
        assert_eq!([0.05, 3.21, 4500.0, 2e6].map(duration), ["50 ns", "3.2 us", "4.50 ms", "2.00 s"]);
    }

    #[test]
    fn any_text_fits_on_one_line() {
        assert_eq!(one_line("a\nb\u{1b}[1m'c'"), "a\\nb\\u{1b}[1m'c'");
    }
}
