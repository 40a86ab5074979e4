//! Real models for tests, and the tests that were skipped without them.
//!
//! The models are not part of the project: `SSCC_MODELS` names their folder, else it is `shared/models` beside the
//! workspace. A test that needs them and finds none says so and passes; `cargo xtask test` lists those tests at its end,
//! and fails because of them when `SSCC_NO_SKIPS` is set.
#![allow(clippy::print_stderr)]

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Names a file to which skipped tests add a line each.
pub const SKIP_LOG: &str = "SSCC_SKIP_LOG";

/// The folder of the real models; without it, the test of that name is noted as skipped.
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

/// Notes that a test was skipped, and why.
pub fn skip(test: &str, reason: &str) {
    let line = format!("SKIPPED: {test}: {reason}\n");
    eprint!("{line}");
    if let Some(path) = std::env::var_os(SKIP_LOG) {
        // One write, so that tests of several threads and programs do not tear each other's lines.
        let log = OpenOptions::new().append(true).create(true).open(&path);
        if let Err(error) = log.and_then(|mut log| log.write_all(line.as_bytes())) {
            panic!("{}: {error}", PathBuf::from(path).display());
        }
    }
}
