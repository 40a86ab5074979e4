//! `cargo xtask soundness`: searches for wrong answers of the core by exact arithmetic (`crates/sscc-soundness`), for hours
//! if wanted.
//!
//! The counters are in `target/soundness.csv`, so that a campaign can resume; `--write` then copies them to [`SUMMARY`].

use std::fs;
use std::process::ExitCode;

use crate::program::{cargo, exit_code, root, succeed};

/// The file with the counters of a campaign, relative to the root.
const RECORD: &str = "target/soundness.csv";

/// The file with the summary that documents show, relative to the root.
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
