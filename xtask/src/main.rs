//! Tasks of the project: `cargo xtask test` runs every test and says what it skipped.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod test;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    match args.next().as_deref() {
        Some("test") => test::run(args.collect()),
        Some(other) => {
            eprintln!("error: no task '{other}'; there is: test");
            ExitCode::from(2)
        }
        None => {
            eprintln!("Usage: cargo xtask test [arguments for cargo test]");
            ExitCode::from(2)
        }
    }
}
