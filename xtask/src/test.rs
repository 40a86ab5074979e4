//! `cargo xtask test`: runs all tests of all crates with the examples in their documentation, then at the same time those of
//! the Python package, of the page, of the site and of C, and the lemmas, since none of these keeps two cores busy. With
//! arguments for `cargo test` it runs only the tests of the crates. The package for npm has its own task,
//! `cargo xtask wasm --test`.
//!
//! The task forwards the output line by line. Then it lists the skipped tests, and prints `N passed, N failed` as the
//! last line. Skipped tests fail the run when `SSCC_NO_SKIPS` is set and not empty.

use std::path::Path;
use std::process::ExitCode;
use std::thread;

use crate::program::{cargo, run_and_forward};
use crate::tally::{SkipLog, Tally};
use crate::{c, lemmas, page, python, site};

/// Runs all tests. With arguments for `cargo test`, runs only those of the crates.
pub fn run(arguments: &[String]) -> ExitCode {
    let log = SkipLog::new();
    let mut tally = cargo_test(arguments, log.path());
    if arguments.is_empty() {
        let path = log.path();
        tally += thread::scope(|scope| {
            let page = scope.spawn(|| site::test(path) + page::test(path, true) + lemmas::test(path, true));
            let c = scope.spawn(|| c::test(path, true));
            let python = python::test(&[], path, true);
            [page, c].into_iter().fold(python, |sum, tests| sum + tests.join().unwrap_or(Tally::BROKEN))
        });
    }
    log.conclude(tally)
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
