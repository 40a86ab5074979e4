//! `cargo xtask mutants`: checks that the tests catch each wrong variant in `crates/sscc/src/mutants/list.rs`.
//! Arguments select mutations by name.
//!
//! The task builds the core once with all mutations. The tests must pass without any mutation. With a mutation, the
//! test in the list must reach the wrong code and fail.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use crate::program::cargo;
use crate::tally::Tally;

/// A wrong variant of a line of the core.
struct Mutation {
    name: &'static str,
    /// The defect in words.
    wrong: &'static str,
    expectation: Expectation,
}

enum Expectation {
    /// The test that must fail: `lib` or the name of a test program, and the name of the test.
    CaughtBy(&'static str),
    /// The reason why no test can fail.
    Covered(&'static str),
}

macro_rules! mutants {
    ($($(#[doc = $wrong:literal])+ $name:ident: $expectation:ident($text:literal);)+) => {
        const ALL: &[Mutation] =
            &[$(Mutation { name: stringify!($name), wrong: concat!($($wrong),+), expectation: Expectation::$expectation($text) }),+];
    };
}

include!("../../crates/sscc/src/mutants/list.rs");

/// Runs the tests, prints a table of mutations, and returns the exit code.
pub fn run(names: &[String]) -> ExitCode {
    match try_run(names) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(line) => {
            eprintln!("error: {line}");
            ExitCode::from(2)
        }
    }
}

fn try_run(names: &[String]) -> Result<bool, String> {
    if let Some(unknown) = names.iter().find(|name| ALL.iter().all(|mutation| mutation.name != *name)) {
        return Err(format!("crates/sscc/src/mutants/list.rs has no mutation '{unknown}'"));
    }
    check_uses()?;
    let mutations: Vec<&Mutation> = ALL
        .iter()
        .filter(|mutation| names.is_empty() || names.iter().any(|name| name == mutation.name))
        .collect();
    let tests = tests(&mutations)?;
    build(&tests)?;
    for &test in &tests {
        let outcome = outcome(test, None)?;
        if !outcome.is_pass() {
            return Err(format!(
                "{} {} does not pass without any mutation: {}",
                test.0,
                test.1,
                outcome.description()
            ));
        }
    }
    let width = mutations.iter().map(|mutation| mutation.name.len()).max().unwrap_or(0);
    let mut survived = 0;
    for mutation in mutations.iter() {
        let (is_fine, result) = match mutation.expectation {
            Expectation::Covered(reason) => (true, format!("covered: {reason}")),
            Expectation::CaughtBy(test) => {
                let outcome = outcome(parts(test)?, Some(mutation.name))?;
                let prefix =
                    if outcome.is_caught() { String::new() } else { format!("{}: ", outcome.description()) };
                (outcome.is_caught(), prefix + test)
            }
        };
        survived += usize::from(!is_fine);
        println!("{:width$}  {result}", mutation.name);
        if !is_fine {
            println!("{:width$}  {}", "", mutation.wrong.trim());
        }
    }
    let covered =
        mutations.iter().filter(|mutation| matches!(mutation.expectation, Expectation::Covered(_))).count();
    println!("\n{} caught, {covered} covered, {survived} survived", mutations.len() - covered - survived);
    Ok(survived == 0)
}

/// Splits an entry of the list into target and name of the test.
fn parts(test: &'static str) -> Result<(&'static str, &'static str), String> {
    test.split_once(' ').ok_or_else(|| format!("list.rs: '{test}': expected a target and a test"))
}

/// Returns the tests that must catch these mutations, each once.
fn tests(mutations: &[&Mutation]) -> Result<BTreeSet<(&'static str, &'static str)>, String> {
    let caught = mutations.iter().filter_map(|mutation| match mutation.expectation {
        Expectation::CaughtBy(test) => Some(parts(test)),
        Expectation::Covered(_) => None,
    });
    caught.collect()
}

/// Returns an error if no code of the core has a mutation of the list. Code with an unlisted mutation does not compile.
fn check_uses() -> Result<(), String> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/sscc/src");
    let mut files = Vec::new();
    collect(&source, &mut files).map_err(|error| format!("{}: {error}", source.display()))?;
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut words = BTreeSet::new();
    for file in files {
        let text = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
        for (at, _) in text.match_indices("with_mutant!(") {
            words
                .extend(text[at..].split(';').next().unwrap_or("").split(|c| !is_part(c)).map(str::to_owned));
        }
    }
    match ALL.iter().find(|mutation| !words.contains(mutation.name)) {
        Some(mutation) => Err(format!("crates/sscc/src/mutants/list.rs: no code has '{}'", mutation.name)),
        None => Ok(()),
    }
}

/// Adds the source files below a folder, without those of the module `mutants`.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() && !path.ends_with("mutants") {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Returns `cargo test` for the core with all mutations and with all random cases, since few cases catch some
/// mutations.
fn cargo_test(targets: impl IntoIterator<Item = &'static str>) -> Command {
    let mut command = cargo();
    command.args(["test", "--quiet", "--package", "sscc", "--features", "mutants"]);
    for target in targets {
        if target == "lib" {
            command.arg("--lib");
        } else {
            command.args(["--test", target]);
        }
    }
    command.env_remove("SSCC_MUTANT").env("CI", "true");
    command
}

fn build(tests: &BTreeSet<(&'static str, &'static str)>) -> Result<(), String> {
    let targets: BTreeSet<&str> = tests.iter().map(|(target, _)| *target).collect();
    let status = cargo_test(targets).arg("--no-run").status();
    match status.map_err(|error| format!("cargo cannot be run: {error}"))?.success() {
        true => Ok(()),
        false => Err("the core cannot be built with mutations (see above)".to_owned()),
    }
}

/// The outcome of a single test.
struct Outcome {
    tally: Tally,
    /// Whether the test ran the wrong code.
    reached: bool,
}

impl Outcome {
    fn is_pass(&self) -> bool {
        self.tally == Tally { passed: 1, failed: 0 }
    }

    fn is_caught(&self) -> bool {
        self.tally == Tally { passed: 0, failed: 1 } && self.reached
    }

    fn description(&self) -> &'static str {
        match (self.tally, self.reached) {
            (Tally { passed: 0, failed: 0 }, _) => "NO SUCH TEST, or it did not run to its end",
            (Tally { failed: 0, .. }, false) => "NOT REACHED",
            (Tally { failed: 0, .. }, true) => "SURVIVED",
            (Tally { passed: 0, .. }, _) => "it fails",
            _ => "MORE THAN ONE TEST",
        }
    }
}

/// Runs one test with or without a mutation.
fn outcome((target, test): (&'static str, &'static str), mutation: Option<&str>) -> Result<Outcome, String> {
    let mut command = cargo_test([target]);
    command.args(["--", "--exact", test]);
    if let Some(name) = mutation {
        command.env("SSCC_MUTANT", name);
    }
    let output = command.output().map_err(|error| format!("cargo cannot be run: {error}"))?;
    let mut tally = Tally::default();
    String::from_utf8_lossy(&output.stdout).lines().for_each(|line| tally.add_rust(line));
    let reached = String::from_utf8_lossy(&output.stderr).lines().any(|line| line.contains("mutant reached"));
    Ok(Outcome { tally, reached })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_mutations_are_in_the_code_and_have_a_test() {
        check_uses().unwrap();
        let names: BTreeSet<&str> = ALL.iter().map(|mutation| mutation.name).collect();
        assert_eq!(names.len(), ALL.len());
        assert!(tests(&ALL.iter().collect::<Vec<_>>()).unwrap().len() > 10);
        assert!(ALL.iter().all(|mutation| !mutation.wrong.is_empty()));
    }

    #[test]
    fn only_a_test_that_reaches_the_wrong_code_and_fails_catches() {
        let outcome = |passed, failed, reached| Outcome { tally: Tally { passed, failed }, reached };
        assert!(outcome(0, 1, true).is_caught() && outcome(1, 0, false).is_pass());
        for (passed, failed, reached) in
            [(1, 0, true), (1, 0, false), (0, 0, true), (0, 1, false), (1, 1, true)]
        {
            assert!(!outcome(passed, failed, reached).is_caught());
        }
    }
}
