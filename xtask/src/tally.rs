//! Counts test results, and logs skipped tests.

use std::env;
use std::fs;
use std::io::Write;
use std::ops::{Add, AddAssign};
use std::path::{Path, PathBuf};
use std::process::{self, ExitCode};

/// Counts of tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    pub passed: u64,
    pub failed: u64,
}

impl Tally {
    /// The tally of tests that could not be run.
    pub const BROKEN: Self = Self { passed: 0, failed: 1 };

    /// Adds a line `test result: ok. 3 passed; 0 failed; ...` of Rust's harness, and ignores all other lines.
    pub fn add_rust(&mut self, line: &str) {
        let Some(result) = line.strip_prefix("test result: ") else { return };
        self.passed += count(result, "passed");
        self.failed += count(result, "failed");
    }

    /// Adds a line `3 passed, 1 skipped in 0.12s` of pytest, and ignores all other lines. Skipped tests count as
    /// passed, as in Rust's harness; the log lists them.
    pub fn add_pytest(&mut self, line: &str) {
        let line = line.trim_matches(['=', ' ']);
        let ends_in_time =
            line.rsplit_once(" in ").is_some_and(|(_, time)| time.starts_with(|c: char| c.is_ascii_digit()));
        if !ends_in_time || !line.starts_with(|c: char| c.is_ascii_digit()) {
            return;
        }
        self.passed += count(line, "passed") + count(line, "skipped");
        self.failed += count(line, "failed") + count(line, "error") + count(line, "errors");
    }
}

impl Add for Tally {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { passed: self.passed + other.passed, failed: self.failed + other.failed }
    }
}

impl AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// Returns the number before a word.
fn count(line: &str, what: &str) -> u64 {
    let words: Vec<&str> = line.split([' ', ';', ',']).filter(|word| !word.is_empty()).collect();
    words.windows(2).find(|w| w[1] == what).and_then(|w| w[0].parse().ok()).unwrap_or(0)
}

/// The file to which skipped tests add a line. [`SkipLog::conclude`] removes it.
pub struct SkipLog(PathBuf);

impl SkipLog {
    /// Creates an empty log in the system's temporary folder.
    pub fn new() -> Self {
        let path = env::temp_dir().join(format!("sscc-skipped-{}.txt", process::id()));
        let _ = fs::remove_file(&path);
        Self(path)
    }

    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Prints and logs skipped tests with the reason.
    pub fn skip(log: &Path, what: &str, why: &str) -> Tally {
        println!("SKIPPED: {what}: {why}");
        let noted = fs::OpenOptions::new()
            .append(true)
            .create(true)
            .open(log)
            .and_then(|mut file| writeln!(file, "SKIPPED: {what}: {why}"));
        // `conclude` subtracts the lines of the log from the passed tests.
        if noted.is_ok() { Tally { passed: 1, failed: 0 } } else { Tally::BROKEN }
    }

    /// Whether a skipped test counts as failed.
    pub fn is_strict() -> bool {
        env::var_os("SSCC_NO_SKIPS").is_some_and(|value| !value.is_empty())
    }

    /// Prints the skipped tests and, as the last line, `N passed, N failed`. Returns the exit code.
    pub fn conclude(self, mut tally: Tally) -> ExitCode {
        let skipped = fs::read_to_string(&self.0).unwrap_or_default();
        let _ = fs::remove_file(&self.0);
        let mut skipped: Vec<&str> = skipped.lines().collect();
        skipped.sort_unstable();
        println!();
        skipped.iter().for_each(|line| println!("{line}"));
        if Self::is_strict() && !skipped.is_empty() {
            println!("error: SSCC_NO_SKIPS is set, so skipped tests count as failed");
            tally.failed += skipped.len() as u64;
        }
        // The harness counts skipped tests as passed.
        tally.passed = tally.passed.saturating_sub(skipped.len() as u64);
        if !skipped.is_empty() {
            println!("{} skipped, named above", skipped.len());
        }
        println!("{} passed, {} failed", tally.passed, tally.failed);
        if tally.failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_added_up() {
        let mut tally = Tally::default();
        tally.add_rust("running 3 tests");
        tally.add_rust(
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 2 filtered out; finished in 0.1s",
        );
        tally.add_rust("test result: FAILED. 4 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out");
        assert_eq!(tally, Tally { passed: 7, failed: 2 });
        tally.add_pytest("tests/test_a.py ....   [100%]");
        tally.add_pytest("===== 5 passed, 2 skipped in 1.23s =====");
        tally.add_pytest("1 failed, 4 passed, 2 errors in 61.00s (0:01:01)");
        tally.add_pytest("3 passed in the middle");
        assert_eq!(tally, Tally { passed: 18, failed: 5 });
    }
}
