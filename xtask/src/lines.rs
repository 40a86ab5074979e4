//! `cargo xtask lines`: counts the lines of Rust that make up the product.
//!
//! These are the lines of all crates, of the Python package and of the tasks. They exclude comments, blank lines, items for
//! tests (`#[cfg(test)]`, `#[test]`) with their files, `tests/`, `benches/`, `examples/`, and the crates for tests and
//! examples.

use std::path::Path;
use std::process::ExitCode;

use crate::sources;

/// Crates that are not part of the product.
const NOT_COUNTED: [&str; 3] = ["sscc-testing", "sscc-soundness", "sscc-examples"];

/// Prints the lines of each crate, and their sum.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        eprintln!("Usage: cargo xtask lines");
        return ExitCode::from(2);
    }
    let crates = match sources::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")) {
        Ok(crates) => crates,
        Err(line) => {
            eprintln!("error: {line}");
            return ExitCode::from(2);
        }
    };
    let mut all = 0;
    for krate in crates.iter().filter(|krate| !NOT_COUNTED.contains(&&*krate.name)) {
        let lines: usize = krate.files.iter().map(|file| file.lines.len()).sum();
        println!("{lines:>7}  {}", krate.name);
        all += lines;
    }
    println!("{all:>7}  all");
    ExitCode::SUCCESS
}
