//! `cargo xtask test`: runs all tests of all crates with the examples in their documentation, and at the same time those of
//! the site and the page, and the lemmas; then those of the Python package and of C. None of these keeps two cores busy. With
//! arguments for `cargo test` it runs only the tests of the crates. The package for npm has its own task,
//! `cargo xtask wasm --test`.
//!
//! The task forwards the output line by line. Then it lists the skipped tests, and prints `N passed, N failed` as the
//! last line. Skipped tests fail the run when `SSCC_NO_SKIPS` is set and not empty.

use std::path::Path;
use std::process::ExitCode;
use std::thread;

use crate::program::{cargo, run_and_forward, succeed};
use crate::tally::{SkipLog, Tally};
use crate::{c, lemmas, page, python, site};

/// Runs all tests. With arguments for `cargo test`, runs only those of the crates.
pub fn run(arguments: &[String]) -> ExitCode {
    let log = SkipLog::new();
    let tally = if arguments.is_empty() { test_all(log.path()) } else { cargo_test(arguments, log.path()) };
    log.conclude(tally)
}

fn test_all(log: &Path) -> Tally {
    // All programs are compiled before any of them runs, because the compiler keeps all cores busy.
    let mut compile = cargo();
    compile.args(["test", "--workspace", "--no-run"]);
    if let Err(line) = succeed(&mut compile, "the tests cannot be compiled") {
        println!("error: {line}");
        return Tally::BROKEN;
    }
    thread::scope(|scope| {
        let page = scope.spawn(|| site::test(log) + page::test(log, true) + lemmas::test(log, true));
        let crates = cargo_test(&[], log);
        let c = scope.spawn(|| c::test(log, true));
        let others = crates + python::test(&[], log, true);
        [page, c].into_iter().fold(others, |sum, tests| sum + tests.join().unwrap_or(Tally::BROKEN))
    })
}

fn cargo_test(arguments: &[String], log: &Path) -> Tally {
    let mut command = cargo();
    command.args(["test", "--workspace", "--no-fail-fast"]).args(arguments).env("SSCC_SKIP_LOG", log);
    let mut tally = Tally::default();
    match run_and_forward(&mut command, |line| tally.add_rust(line)) {
        Err(error) => {
            println!("error: cargo cannot be run: {error}");
            tally.failed += 1;
        }
        Ok(false) if tally.failed == 0 => {
            println!("error: cargo test did not run to its end (see above)");
            tally.failed = 1;
        }
        Ok(_) => {}
    }
    tally
}
