//! `cargo xtask operators`: changes an operator, or replaces a function, of the code that answers rest on, and counts the
//! variants that a test catches. `operators/` has the program that makes the variants.
//!
//! All variants are compiled at once, in a copy of the workspace, and selected when a test runs. The variants to run are drawn
//! at random, if paths are given from the files whose names begin with them; `--write` replaces the rows of their folders in the
//! record. Each runs the tests that reach it: those of its own module first, then the quickest, for at most T seconds.

mod compile;
mod programs;
mod trials;

use std::process::ExitCode;
use std::time::Duration;

use crate::program::{exit_code, usage};

const USAGE: &str =
    "operators [--count N] [--seed S] [--seconds T] [--write] [paths]    (N and T at least 1)";

/// Makes all variants, and runs some of them.
pub fn run(arguments: &[String]) -> ExitCode {
    let (mut count, mut seed, mut seconds, mut writes) = (20, 1, 60, false);
    let mut paths = Vec::new();
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        let mut number = |least: u64| {
            arguments.next().and_then(|text| text.parse::<u64>().ok()).filter(|number| *number >= least)
        };
        let (place, value) = match argument.as_str() {
            "--count" => (&mut count, number(1)),
            "--seed" => (&mut seed, number(0)),
            "--seconds" => (&mut seconds, number(1)),
            "--write" => {
                writes = true;
                continue;
            }
            path if !path.starts_with('-') => {
                paths.push(path.to_owned());
                continue;
            }
            _ => return usage(USAGE),
        };
        match value {
            Some(value) => *place = value,
            None => return usage(USAGE),
        }
    }
    exit_code(compile::compile().and_then(|(variants, programs)| {
        let tests = programs::tests(&programs, Duration::from_secs(seconds))?;
        trials::run(&variants, &tests, &trials::Draw { count, seed, seconds, paths }, writes)
    }))
}
