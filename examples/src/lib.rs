//! Code that the example programs share: a small model for runs without arguments, and the exit code.

#![doc(test(attr(deny(warnings))))]

mod mouth;

use std::error::Error;
use std::process::ExitCode;

pub use mouth::{mouth_glb, mouth_vegafem, mouths_npz};

/// Returns the exit code of a program: 1 for an error, which is printed as one line on standard error.
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

/// Compiles the Rust example of the README as a test of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}

/// Runs the Rust example of the first page of the site.
#[cfg(doctest)]
#[doc = include_str!("../../docs/index.md")]
mod first_page {}

/// Runs the Rust example of the page about Rust.
#[cfg(doctest)]
#[doc = include_str!("../../docs/rust.md")]
mod rust_page {}
