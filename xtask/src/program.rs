//! Runs other programs for the tasks.

use std::env;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Command, Stdio};

/// Returns the cargo that started this program.
pub fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a command, forwards its standard output line by line, and calls `each` with every line. Returns whether the
/// command succeeded.
pub fn run_and_forward(command: &mut Command, mut each: impl FnMut(&str)) -> io::Result<bool> {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    if let Some(stdout) = child.stdout.take() {
        let mut out = io::stdout();
        for line in BufReader::new(stdout).split(b'\n') {
            let line = line?;
            let text = String::from_utf8_lossy(&line);
            each(&text);
            writeln!(out, "{text}")?;
            out.flush()?;
        }
    }
    Ok(child.wait()?.success())
}
