//! The `sscc` command: computes certificates of deformable models, and answers self-collision queries.
//!
//! `args` parses the arguments, `commands` executes them, and this file decides the exit code.

mod args;
mod commands;
mod flags;
mod interrupt;
mod load;
mod meter;
mod model_scene;
mod outcome;
mod output;
mod progress;
mod stages;
mod threads;
mod usage;

use std::process::ExitCode;

use outcome::{EXIT_ERROR, EXIT_FINDING, EXIT_INTERRUPTED, Outcome};

/// Runs the program, and returns its exit code.
pub fn main() -> ExitCode {
    let cli = match args::parse(std::env::args_os()) {
        Ok(cli) => cli,
        Err(error) => return usage::report(&error),
    };
    interrupt::install_handlers();
    match threads::begin().and_then(|()| commands::run(cli)) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Finding) => ExitCode::from(EXIT_FINDING),
        Err(error) => {
            output::write_stderr(format_args!("error: {}", interrupt::message(&error)));
            ExitCode::from(if interrupt::is_interrupted() { EXIT_INTERRUPTED } else { EXIT_ERROR })
        }
    }
}
