//! The `sscc` command: certify a deformable model once, then ask whether it collides with itself.
//!
//! `args` holds what was typed, `commands` what it means; exit codes are decided here.

mod args;
mod commands;
mod interrupt;
mod load;
mod meter;
mod output;
mod progress;
mod stages;
mod usage;

use std::process::ExitCode;

use clap::Parser;

/// What a command that ran to its end has to say by its exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Done; `check`: every q is free.
    Done,
    /// `check` found a collision, `audit` a violation.
    Found,
}

const EXIT_FOUND: u8 = 1;
const EXIT_ERROR: u8 = 2;
/// What shells report for a program that was interrupted.
const EXIT_INTERRUPTED: u8 = 130;

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
