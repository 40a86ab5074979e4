//! Real models for tests, and a log of the tests that were skipped without them.
//!
//! The models are not part of the project. `SSCC_MODELS` names their folder; the default is `shared/models` beside the
//! workspace. A test that finds no models prints a line and passes. `cargo xtask test` lists these tests at its end, and
//! fails because of them if `SSCC_NO_SKIPS` is set.
#![allow(clippy::print_stderr)]

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Environment variable with the name of a file to which each skipped test appends a line.
pub const SKIP_LOG: &str = "SSCC_SKIP_LOG";

/// Returns the folder of the real models. If it does not exist, records the test of this name as skipped.
pub fn models(test: &str) -> Option<PathBuf> {
    let folder = match std::env::var_os("SSCC_MODELS") {
        Some(folder) => PathBuf::from(folder),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/models"),
    };
    if folder.is_dir() {
        return Some(folder);
    }
    skip(test, "no real models found; set SSCC_MODELS to their folder");
    None
}

/// Records a skipped test with the reason, on stderr and in the file of [`SKIP_LOG`].
///
/// # Panics
/// When the file cannot be written.
pub fn skip(test: &str, reason: &str) {
    let line = format!("SKIPPED: {test}: {reason}\n");
    eprint!("{line}");
    if let Some(path) = std::env::var_os(SKIP_LOG) {
        // One write for each line, so that lines of several threads and processes do not mix.
        let log = OpenOptions::new().append(true).create(true).open(&path);
        if let Err(error) = log.and_then(|mut log| log.write_all(line.as_bytes())) {
            panic!("{}: {error}", PathBuf::from(path).display());
        }
    }
}
