//! `cargo xtask digests`: prints digests of the certificates and answers of five small models, and compares them with those
//! in [`RECORD`]. The digests are the same on every machine.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use crate::program::{cargo, exit_code, output, root, usage};

/// The record, below the root.
const RECORD: &str = "docs/records/digests.txt";

/// Compares the digests with the record; with `--write`, writes the record.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(print(false)),
        [flag] if flag == "--write" => exit_code(print(true)),
        _ => usage("digests [--write]    (digests of certificates and answers; --write: writes the record)"),
    }
}

/// Writes the models and the bytes of certificates and answers to a folder, and compares their digests.
pub fn write_bytes(folder: &Path) -> Result<(), String> {
    compare(&compute(Some(folder))?)
}

/// Runs the example, and returns its output.
fn compute(folder: Option<&Path>) -> Result<String, String> {
    let mut program = cargo();
    program
        .args(["run", "--quiet", "--package", "sscc-examples", "--example", "digests", "--"])
        .args(folder)
        .current_dir(root());
    output(&mut program, "the digests cannot be computed")
}

/// Prints the digests, and compares them or writes the record.
fn print(write: bool) -> Result<(), String> {
    let found = compute(None)?;
    print!("{found}");
    if !write {
        return compare(&found);
    }
    fs::write(root().join(RECORD), found).map_err(|error| format!("{RECORD}: {error}"))
}

fn compare(found: &str) -> Result<(), String> {
    let path = root().join(RECORD);
    let record = fs::read_to_string(&path).map_err(|error| format!("{RECORD}: {error}"))?;
    match found.lines().zip(record.lines()).find(|(found, record)| found != record) {
        Some((found, record)) => {
            Err(format!("{RECORD} has '{}', but the digest is '{}'", record.trim(), found.trim()))
        }
        None if found.lines().count() != record.lines().count() => {
            Err(format!("{RECORD} has another number of lines; to replace it: cargo xtask digests --write"))
        }
        None => Ok(()),
    }
}
