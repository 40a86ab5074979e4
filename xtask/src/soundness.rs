//! `cargo xtask soundness`: attacks the core's answers with exact arithmetic (`crates/sscc-soundness`), for hours if wanted.
//!
//! The counters are in `target/soundness.csv`, so that a campaign resumes; `--write` then copies them to [`SUMMARY`].

use std::fs;
use std::process::ExitCode;

use crate::program::{cargo, exit_code, root, succeed};

/// The counters of a campaign, below the root.
const RECORD: &str = "target/soundness.csv";

/// The summary that documents show, below the root.
const SUMMARY: &str = "docs/records/soundness.csv";

/// Runs the campaign with these arguments, or writes its summary.
pub fn run(arguments: &[String]) -> ExitCode {
    if let [flag] = arguments
        && flag == "--write"
    {
        return exit_code(write());
    }
    let mut program = cargo();
    program.args(["run", "--release", "--quiet", "--package", "sscc-soundness", "--"]).args(arguments);
    exit_code(succeed(program.current_dir(root()), "the campaign has found a defect, or could not run"))
}

fn write() -> Result<(), String> {
    fs::copy(root().join(RECORD), root().join(SUMMARY))
        .map(|_| ())
        .map_err(|error| format!("{RECORD}: {error}; run cargo xtask soundness --hours 1 first"))
}
