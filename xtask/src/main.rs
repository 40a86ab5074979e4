//! Tasks of the project: `cargo xtask test` runs every test and says what it skipped, `cargo xtask python` those of the
//! Python package alone; `cargo xtask page` builds the page, with `--test` it runs the page's own.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod page;
mod python;
mod tally;
mod test;

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    match args.next().as_deref() {
        Some("test") => test::run(args.collect()),
        Some("python") => python::run(args.collect()),
        Some("page") => page::run(&args.collect::<Vec<_>>()),
        Some(other) => {
            eprintln!("error: no task '{other}'; there are: test, python, page");
            ExitCode::from(2)
        }
        None => {
            eprintln!(
                "Usage: cargo xtask test [arguments for cargo test]\n       cargo xtask python [arguments for pytest]\n       cargo xtask page [--write | --test]"
            );
            ExitCode::from(2)
        }
    }
}
