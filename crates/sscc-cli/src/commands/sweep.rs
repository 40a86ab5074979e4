//! `sscc sweep`: for each mode the first weight at which the shape touches itself, or all intervals in which it collides;
//! combinations of two modes.

use anyhow::Result;
use serde::Serialize;
use sscc::SweepOutcome;
use sscc_sim::{
    SweepRequest, combination_table, interval_table, sweep_model, sweep_model_combinations,
    sweep_model_intervals, sweep_table,
};

use crate::args::Sweep;
use crate::outcome::Outcome;
use crate::output::{Output, note};
use crate::progress::Bar;
use crate::{interrupt, load};

pub fn run(args: &Sweep) -> Result<Outcome> {
    let loaded = load::model(&args.model)?;
    let threads = Some(load::threads(&args.options.threads));
    let Sweep { q, range, pose, .. } = args;
    let request = SweepRequest { q: q.clone(), range: range.clone(), pose: pose.clone(), threads };
    // Refused before certificates are computed.
    request.prepare(&loaded, &vec![0.0; loaded.model.rank()])?;
    let ranges = request.ranges(&loaded)?;
    let certificates = match &args.certificates {
        Some(path) => load::request(&loaded, &args.model, &args.options)?.read(path, &loaded.model)?,
        None => load::certificates_now(&loaded, &args.model, &args.options)?,
    };
    let bar = Bar::new("sweeping");
    if let Some(samples) = args.intervals {
        let found = sweep_model_intervals(&loaded, &certificates, &request, samples, &bar);
        interrupt::check()?;
        let rows = found.map_err(|error| load::in_file(error.into(), &args.model.path))?;
        print(args, &rows, || [vec![ranges.to_string()], interval_table(&rows)].concat())?;
        return Ok(outcome(rows.iter().all(|row| row.intervals.is_empty())));
    }
    if args.combinations {
        let found = sweep_model_combinations(&loaded, &certificates, &request, &bar);
        interrupt::check()?;
        let found = found.map_err(|error| load::in_file(error.into(), &args.model.path))?;
        print(args, &found.rows, || [vec![ranges.to_string()], combination_table(&found)].concat())?;
        return Ok(outcome(found.rows.is_empty()));
    }
    let swept = sweep_model(&loaded, &certificates, &request, &bar);
    interrupt::check()?;
    let rows = swept.map_err(|error| load::in_file(error.into(), &args.model.path))?;
    print(args, &rows, || [vec![ranges.to_string()], sweep_table(&rows, "--q, --ignore-rest")].concat())?;
    // The table says so itself.
    if args.json.json && rows.iter().any(|row| row.outcome == SweepOutcome::CollidingAtStart) {
        note("pairs collide at the start: --ignore-rest leaves out those at rest, --q sets other weights");
    }
    Ok(outcome(rows.iter().all(|row| row.outcome == SweepOutcome::Free)))
}

fn print(args: &Sweep, rows: &[impl Serialize], table: impl Fn() -> Vec<String>) -> Result<()> {
    let mut out = Output::new();
    match args.json.json {
        true => rows.iter().try_for_each(|row| out.json(row))?,
        false => table().into_iter().try_for_each(|line| out.line(line))?,
    }
    out.finish()
}

fn outcome(is_free: bool) -> Outcome {
    if is_free { Outcome::Done } else { Outcome::Finding }
}
