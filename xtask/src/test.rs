//! `cargo xtask test`: all tests of all crates, examples in the documentation included.
//!
//! Output is passed on as it comes. Then follow the tests that found their data missing, and as the last line
//! `N passed, N failed`. Skipped tests fail the run when `SSCC_NO_SKIPS` is set and not empty.

use std::env;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{self, Command, ExitCode, Stdio};

use crate::page;

/// Adds up the lines `test result: ok. 3 passed; 0 failed; ...`.
#[derive(Default)]
pub struct Tally {
    pub passed: u64,
    pub failed: u64,
}

impl Tally {
    pub fn add(&mut self, other: &Tally) {
        self.passed += other.passed;
        self.failed += other.failed;
    }

    fn add_line(&mut self, line: &str) {
        let Some(result) = line.strip_prefix("test result: ") else { return };
        let count = |what: &str| {
            let words: Vec<&str> = result.split([' ', ';']).filter(|w| !w.is_empty()).collect();
            words.windows(2).find(|w| w[1] == what).and_then(|w| w[0].parse::<u64>().ok()).unwrap_or(0)
        };
        self.passed += count("passed");
        self.failed += count("failed");
    }
}

pub fn run(arguments: Vec<String>) -> ExitCode {
    let log = env::temp_dir().join(format!("sscc-skipped-{}.txt", process::id()));
    let _ = fs::remove_file(&log);
    let result = cargo_test(&arguments, &log);
    let skipped = fs::read_to_string(&log).unwrap_or_default();
    let _ = fs::remove_file(&log);
    let (mut tally, success) = match result {
        Ok(result) => result,
        Err(error) => {
            eprintln!("error: cargo cannot be run: {error}");
            (Tally::default(), false)
        }
    };

    let strict = env::var_os("SSCC_NO_SKIPS").is_some_and(|value| !value.is_empty());
    let mut skipped: Vec<&str> = skipped.lines().collect();
    skipped.sort_unstable();
    // Arguments choose among the tests of the crates.
    let page = if arguments.is_empty() { page::test(strict) } else { page::Outcome::default() };
    println!();
    skipped.iter().for_each(|line| println!("{line}"));
    page.skipped.iter().for_each(|line| println!("{line}"));
    if !success && tally.failed == 0 {
        println!("error: cargo test did not run to its end (see above)");
        tally.failed = 1;
    }
    if strict && !(skipped.is_empty() && page.skipped.is_empty()) {
        println!("error: SSCC_NO_SKIPS is set, so skipped tests count as failed");
        tally.failed += (skipped.len() + page.skipped.len()) as u64;
    }
    // To the test harness they passed.
    tally.passed = tally.passed.saturating_sub(skipped.len() as u64);
    tally.add(&page.tally);
    let skips = skipped.len() + page.skipped.len();
    if skips > 0 {
        println!("{skips} skipped, named above");
    }
    println!("{} passed, {} failed", tally.passed, tally.failed);
    if tally.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Runs all tests; what they came to, and whether cargo was content.
fn cargo_test(arguments: &[String], log: &PathBuf) -> io::Result<(Tally, bool)> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut child = Command::new(cargo)
        .args(["test", "--workspace", "--no-fail-fast"])
        .args(arguments)
        .env("SSCC_SKIP_LOG", log)
        .stdout(Stdio::piped())
        .spawn()?;
    let mut tally = Tally::default();
    if let Some(stdout) = child.stdout.take() {
        let mut out = io::stdout();
        for line in BufReader::new(stdout).split(b'\n') {
            let line = line?;
            let text = String::from_utf8_lossy(&line);
            tally.add_line(&text);
            writeln!(out, "{text}")?;
            out.flush()?;
        }
    }
    Ok((tally, child.wait()?.success()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_added_up() {
        let mut tally = Tally::default();
        tally.add_line("running 3 tests");
        tally.add_line(
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 2 filtered out; finished in 0.1s",
        );
        tally.add_line("test result: FAILED. 4 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out");
        assert_eq!((tally.passed, tally.failed), (7, 2));
    }
}
