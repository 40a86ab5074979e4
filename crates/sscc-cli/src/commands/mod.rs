//! Executes the subcommands, one file or folder for each.

mod audit;
mod bench;
mod certify;
mod check;
mod demo;
mod fit;
mod info;
mod load;
mod modes;
mod resolve;
mod simulate;
mod sweep;
mod view;
mod zero_radius;

use crate::args::{Cli, Command};
use crate::outcome::Outcome;

/// Runs a subcommand.
pub fn run(cli: Cli) -> anyhow::Result<Outcome> {
    match cli.command {
        Command::Demo(args) => demo::run(&args),
        Command::Modes(args) => modes::run(&args),
        Command::Certify(args) => certify::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Sweep(args) => sweep::run(&args),
        Command::Resolve(args) => resolve::run(&args),
        Command::Load(args) => load::run(&args),
        Command::Fit(args) => fit::run(&args),
        Command::Audit(args) => audit::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::View(args) => view::run(&args),
    }
}
