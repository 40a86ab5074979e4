//! `cargo xtask digests`: prints digests of certificates and answers of five small models, and compares them with those in
//! [`RECORD`], which are the same on every machine.

use std::fs;
use std::process::ExitCode;

use crate::program::{cargo, exit_code, output, root, usage};

/// The record, below the root.
const RECORD: &str = "docs/records/digests.txt";

/// Compares, or with `--write` writes the record.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(compare(false)),
        [flag] if flag == "--write" => exit_code(compare(true)),
        _ => usage("digests [--write]    (digests of certificates and answers; --write: writes the record)"),
    }
}

fn compare(write: bool) -> Result<(), String> {
    let mut program = cargo();
    program
        .args(["run", "--quiet", "--package", "sscc-examples", "--example", "digests"])
        .current_dir(root());
    let found = output(&mut program, "the digests cannot be computed")?;
    print!("{found}");
    let path = root().join(RECORD);
    if write {
        return fs::write(&path, found).map_err(|error| format!("{RECORD}: {error}"));
    }
    let record = fs::read_to_string(&path).map_err(|error| format!("{RECORD}: {error}"))?;
    match found.lines().zip(record.lines()).find(|(found, record)| found != record) {
        Some((found, record)) => Err(format!("{RECORD} has '{}', found '{}'", record.trim(), found.trim())),
        None if found.lines().count() != record.lines().count() => {
            Err(format!("{RECORD} has another number of lines; cargo xtask digests --write"))
        }
        None => Ok(()),
    }
}
