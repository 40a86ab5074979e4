//! Runs other programs for the tasks.

use std::env;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

/// Returns a command of the cargo that started this program, which builds as [`build_from_nothing`] states.
pub fn cargo() -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build_from_nothing(&mut cargo);
    cargo
}

/// Disables incremental compilation unless a crate of the project was compiled with it before. Incremental compilation
/// would make the first build of the tests a twentieth longer, and the first build of the wheel twice as long.
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

/// Returns the root of the workspace.
pub fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    // On Windows the path keeps its form: few programs understand the verbatim prefix of a canonical path.
    fs::canonicalize(&root).ok().filter(|_| !cfg!(windows)).unwrap_or(root)
}

/// Runs a command to its end. Returns the error `failure` if it fails.
pub fn succeed(command: &mut Command, failure: &str) -> Result<(), String> {
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!("{failure} (see above)")),
        Err(error) => Err(format!("{failure}: {error}")),
    }
}

/// Runs a command, and returns its output as text. Returns the error `failure` if it fails.
pub fn output(command: &mut Command, failure: &str) -> Result<String, String> {
    let output = command.stderr(Stdio::inherit()).output().map_err(|error| format!("{failure}: {error}"))?;
    match output.status.success() {
        true => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
        false => Err(format!("{failure} (see above)")),
    }
}

/// Returns the exit code of a task. Prints an error as one line on standard error.
pub fn exit_code(result: Result<(), String>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(line) => {
            eprintln!("error: {line}");
            ExitCode::FAILURE
        }
    }
}

/// Prints the usage, and returns the exit code of wrong arguments.
pub fn usage(line: &str) -> ExitCode {
    eprintln!("Usage: cargo xtask {line}");
    ExitCode::from(2)
}
