//! The `sscc` command: certificates of a deformable model, and queries whether it collides with itself.
//!
//! `args` has the typed arguments, `commands` their meaning. The exit code is decided here.

mod args;
mod commands;
mod interrupt;
mod load;
mod meter;
mod outcome;
mod output;
mod progress;
mod stages;
mod usage;

use std::process::ExitCode;

use clap::Parser;

use outcome::{EXIT_ERROR, EXIT_FOUND, EXIT_INTERRUPTED, Outcome};

/// The program: does what its arguments say.
pub fn main() -> ExitCode {
    let cli = match args::Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage::report(&error),
    };
    interrupt::listen();
    match commands::run(cli) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Found) => ExitCode::from(EXIT_FOUND),
        Err(error) => {
            output::say(format_args!("error: {}", interrupt::message(&error)));
            ExitCode::from(if interrupt::happened() { EXIT_INTERRUPTED } else { EXIT_ERROR })
        }
    }
}
