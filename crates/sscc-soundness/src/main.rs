//! The campaign as a program: `cargo xtask soundness`.
#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use sscc_soundness::{Campaign, Record, replay, run, run_quick};

const USAGE: &str = "Usage: cargo xtask soundness [--hours H] [--seed S] [--record FILE] [--path NAME]
       cargo xtask soundness --quick [--path NAME] [--configurations N] [--seed S]
       cargo xtask soundness --path NAME --configuration N [--seed S]    (runs one configuration again)";

/// Number of configurations of each path in a quick run.
const QUICK_CONFIGURATIONS: u64 = 3;

/// The arguments of the command.
#[derive(Default)]
struct Arguments {
    hours: Option<f64>,
    seed: Option<u64>,
    record: Option<PathBuf>,
    path: Option<String>,
    configuration: Option<u64>,
    configurations: Option<u64>,
    quick: bool,
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut parsed = Arguments::default();
    while let Some(flag) = arguments.next() {
        if flag == "--quick" {
            parsed.quick = true;
            continue;
        }
        let value = arguments.next().ok_or_else(|| format!("{flag}: a value is missing"))?;
        let wrong = || format!("{flag}: '{value}' is not a valid number");
        match flag.as_str() {
            "--hours" => {
                let hours = value.parse().ok().filter(|hours| (0.0..=10_000.0).contains(hours));
                parsed.hours = Some(hours.ok_or_else(wrong)?);
            }
            "--seed" => parsed.seed = Some(value.parse().map_err(|_| wrong())?),
            "--configurations" => parsed.configurations = Some(value.parse().map_err(|_| wrong())?),
            "--configuration" => parsed.configuration = Some(value.parse().map_err(|_| wrong())?),
            "--record" => parsed.record = Some(value.into()),
            "--path" => parsed.path = Some(value),
            _ => return Err(format!("unknown option {flag}")),
        }
    }
    Ok(parsed)
}

fn is_clean(record: &Record) -> bool {
    record.paths.iter().all(|path| path.tally.is_clean())
}

fn try_main() -> Result<bool, String> {
    let Arguments { hours, seed, record, path, configuration, configurations, quick } =
        parse(std::env::args().skip(1))?;
    if let Some(number) = configuration {
        let path = path.ok_or("--configuration needs --path")?;
        let tally = replay(&path, seed.unwrap_or(1), number)?;
        println!("{tally:#?}");
        return Ok(tally.is_clean());
    }
    if quick {
        let count = configurations.unwrap_or(QUICK_CONFIGURATIONS);
        let record = run_quick(seed.unwrap_or(1), path.as_deref(), count, |lines| eprint!("{lines}"))?;
        print!("{}", record.table());
        return Ok(is_clean(&record));
    }
    let record = record.unwrap_or_else(|| "target/soundness.csv".into());
    let time = hours.map(|hours| Duration::from_secs_f64(3600.0 * hours));
    let record = run(&Campaign { time, seed, record, path }, |lines| eprint!("{lines}"))?;
    print!("{}", record.table());
    Ok(is_clean(&record))
}

fn main() -> ExitCode {
    match try_main() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(line) => {
            eprintln!("error: {line}\n{USAGE}");
            ExitCode::from(2)
        }
    }
}
