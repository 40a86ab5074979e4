//! `cargo xtask serial`: tests the core without the feature `parallel`, so on one thread and without rayon.
//!
//! These are the test programs of [`TESTS`], compiled without optimisation: optimisation would take longer than it saves.

use std::process::ExitCode;

use crate::program::{cargo, exit_code, root, succeed, usage};

/// Names of tests that certify, query, sweep and audit small models.
const TESTS: [&str; 1] = ["serial"];

/// Runs the tests.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        return usage("serial    (tests the core without threads)");
    }
    let mut test = cargo();
    test.args(["test", "--package", "sscc", "--no-default-features"]).current_dir(root());
    TESTS.iter().for_each(|name| _ = test.args(["--test", name]));
    test.args(["--config", "profile.dev.opt-level=0", "--config", "profile.dev.package.sscc.opt-level=0"]);
    exit_code(succeed(&mut test, "the core fails without threads"))
}
