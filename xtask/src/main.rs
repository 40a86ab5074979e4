//! Tasks of the project.
//!
//! `cargo xtask test` runs all tests and lists the skipped ones. `cargo xtask python` runs those of the Python package.
//! `cargo xtask page` builds the page, and with `--test` runs its tests. `cargo xtask c` runs programs in C and C++. `cargo xtask mutants` checks that the tests of
//! the core catch wrong variants of it. `cargo xtask layers` checks the order of crates and modules. `cargo xtask lines` counts
//! the lines of the product, `cargo xtask public` the public items of the core.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod c;
mod debian;
mod layers;
mod lines;
mod mutants;
mod page;
mod program;
mod public;
mod python;
mod sources;
mod tally;
mod test;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    match args.next().as_deref() {
        Some("test") => test::run(args.collect()),
        Some("python") => python::run(args.collect()),
        Some("layers") => layers::run(&args.collect::<Vec<_>>()),
        Some("lines") => lines::run(&args.collect::<Vec<_>>()),
        Some("public") => public::run(&args.collect::<Vec<_>>()),
        Some("mutants") => mutants::run(&args.collect::<Vec<_>>()),
        Some("c") => c::run(&args.collect::<Vec<_>>()),
        Some("page") => page::run(&args.collect::<Vec<_>>()),
        Some(other) => {
            eprintln!(
                "error: no task '{other}'; there are: test, python, page, c, layers, lines, public, mutants"
            );
            ExitCode::from(2)
        }
        None => {
            eprintln!(
                "Usage: cargo xtask test [arguments for cargo test]\n       cargo xtask python [arguments for pytest]\n       cargo xtask page [--write | --test]\n       cargo xtask c\n       cargo xtask layers\n       cargo xtask lines\n       cargo xtask public [--list]\n       cargo xtask mutants [names]"
            );
            ExitCode::from(2)
        }
    }
}
