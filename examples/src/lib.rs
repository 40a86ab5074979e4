//! What the example programs share: a small model for when they are given no file, and how they end.

mod mouth;

use std::error::Error;
use std::process::ExitCode;

pub use mouth::{mouth_glb, mouth_vegafem, mouths_npz};

/// Ends a program: an error becomes one line on standard error, and exit code 1.
#[allow(clippy::print_stderr)]
pub fn exit_code(outcome: Result<(), Box<dyn Error>>) -> ExitCode {
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
