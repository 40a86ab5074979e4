//! `cargo xtask lint`: checks formatting, lints and documentation. Warnings are errors.

use std::process::ExitCode;

use crate::program::{cargo, exit_code, root, succeed, usage};

/// The steps: arguments for cargo.
const STEPS: [&[&str]; 4] = [
    &["fmt", "--all", "--check"],
    &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"],
    &["clippy", "-p", "sscc", "--no-default-features", "--", "-D", "warnings"],
    &["doc", "--workspace", "--no-deps"],
];

/// Runs the steps, and stops at the first step that fails.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        return usage("lint    (formatting, lints and documentation)");
    }
    exit_code(STEPS.iter().try_for_each(|step| {
        println!("== cargo {}", step.join(" "));
        let mut cargo = cargo();
        cargo.args(*step).current_dir(root()).env("RUSTDOCFLAGS", "-D warnings");
        succeed(&mut cargo, &format!("cargo {} failed", step[0]))
    }))
}
