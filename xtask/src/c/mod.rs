//! `cargo xtask c`: builds programs in C and C++ against `sscc-c` with CMake, and runs them.
//!
//! `crates/sscc-c/tests/programs` is built with gcc and clang, without and with the sanitizers for addresses and undefined
//! behaviour, and runs under valgrind. The package is installed and found by CMake and by pkg-config. The commands of
//! `docs/c.md` are run as shown, and the examples answer as the command does. A check is skipped, and listed by name, if one
//! of its programs is missing. A run that counts skipped tests as failed may install Debian's packages.

mod checks;
mod examples;
mod packages;
mod programs;

use std::path::Path;
use std::process::ExitCode;

use checks::Checks;

use crate::tally::{SkipLog, Tally};

/// Runs the task, and returns its exit code.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        eprintln!("Usage: cargo xtask c");
        return ExitCode::from(2);
    }
    let log = SkipLog::new();
    let tally = test(log.path(), false);
    log.conclude(tally)
}

/// Runs the tests. With `is_built`, `cargo test` has built the library and the command.
pub fn test(log: &Path, is_built: bool) -> Tally {
    println!("== C and C++");
    if !cfg!(target_os = "linux") {
        return SkipLog::skip(log, "programs in C and C++", "they are tested only on Linux");
    }
    if SkipLog::is_strict() {
        packages::install_missing();
    }
    let mut checks = match Checks::new(log, is_built) {
        Ok(checks) => checks,
        Err(line) => {
            println!("error: {line}");
            return Tally::BROKEN;
        }
    };
    programs::run(&mut checks);
    examples::run(&mut checks);
    checks.tally
}
