//! Runs other programs for the tasks.

use std::env;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Command, Stdio};

/// Returns the cargo that started this program.
pub fn cargo() -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build_from_nothing(&mut cargo);
    cargo
}

/// Turns incremental compilation off where no crate of ours was compiled in that way before. It makes the first build of the
/// tests a twentieth longer, and that of the wheel twice as long.
pub fn build_from_nothing(command: &mut Command) {
    let state = env::current_exe().map(|xtask| xtask.with_file_name("incremental"));
    let mut crates = state.and_then(fs::read_dir).into_iter().flatten().flatten();
    if !crates.any(|entry| entry.file_name().to_string_lossy().starts_with("sscc")) {
        command.env("CARGO_INCREMENTAL", "0");
    }
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
