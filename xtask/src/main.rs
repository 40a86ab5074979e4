//! Tasks of the project: `cargo xtask test` runs every test and says what it skipped, `cargo xtask python` those of the
//! Python package.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod python;
mod tally;
mod test;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    match args.next().as_deref() {
        Some("test") => test::run(args.collect()),
        Some("python") => python::run(args.collect()),
        Some(other) => {
            eprintln!("error: no task '{other}'; there are: test, python");
            ExitCode::from(2)
        }
        None => {
            eprintln!(
                "Usage: cargo xtask test [arguments for cargo test]\n       cargo xtask python [arguments for pytest]"
            );
            ExitCode::from(2)
        }
    }
}
