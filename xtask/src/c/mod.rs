//! `cargo xtask c`: builds programs in C and C++ against `sscc-c` with CMake, and runs them.
//!
//! `crates/sscc-c/tests/programs` is built with gcc and clang, as it is and with the sanitizers for addresses and undefined
//! behaviour, and runs under valgrind. The package is installed and found by CMake and by pkg-config. The commands of `docs/c.md` are
//! run as shown, and the examples answer as the command does. Where cmake, a compiler or valgrind is missing, tests are
//! skipped; a run that counts skipped tests as failed may install Debian's packages.

mod checks;
mod examples;
mod programs;

use std::path::Path;
use std::process::ExitCode;

use checks::Checks;

use crate::debian;
use crate::tally::{SkipLog, Tally};

/// Programs that the tests need, and their Debian packages.
const PROGRAMS: [(&str, &str); 8] = [
    ("cmake", "cmake"),
    ("make", "make"),
    ("gcc", "gcc"),
    ("g++", "g++"),
    ("clang", "clang"),
    ("clang++", "clang"),
    ("valgrind", "valgrind"),
    ("pkg-config", "pkg-config"),
];

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
    if let Err(reason) = find_programs() {
        return SkipLog::skip(log, "programs in C and C++", &reason);
    }
    let mut checks = match Checks::new(is_built) {
        Ok(checks) => checks,
        Err(line) => {
            println!("error: {line}");
            return Tally::BROKEN;
        }
    };
    programs::run(&mut checks);
    examples::run(&mut checks, log);
    checks.tally
}

fn find_programs() -> Result<(), String> {
    let missing = || PROGRAMS.iter().filter(|(program, _)| !debian::has(program)).collect::<Vec<_>>();
    if SkipLog::is_strict() {
        let mut packages: Vec<&str> = missing().into_iter().map(|(_, package)| *package).collect();
        // For an example that is left out without it.
        if !Path::new("/usr/include/eigen3").exists() {
            packages.push("libeigen3-dev");
        }
        if !packages.is_empty() {
            debian::install(&packages);
        }
    }
    match missing().first() {
        None => Ok(()),
        Some((program, package)) => Err(format!("{program} is not installed (Debian's {package})")),
    }
}
