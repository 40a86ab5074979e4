//! `sscc sweep`: for each mode the first weight at which the shape touches itself, or all intervals in which it collides;
//! combinations of two modes.

use anyhow::Result;
use serde::Serialize;
use sscc::{Certificates, SweepOutcome};
use sscc_sim::{
    LeftOut, SweepRequest, combination_table, interval_table, sweep_model, sweep_model_combinations,
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
        print(args, &rows, &certificates, || [vec![ranges.to_string()], interval_table(&rows)].concat())?;
        return Ok(outcome(rows.iter().all(|row| row.intervals.is_empty())));
    }
    if args.combinations {
        let found = sweep_model_combinations(&loaded, &certificates, &request, &bar);
        interrupt::check()?;
        let found = found.map_err(|error| load::in_file(error.into(), &args.model.path))?;
        print(args, &found.rows, &certificates, || {
            [vec![ranges.to_string()], combination_table(&found)].concat()
        })?;
        return Ok(outcome(found.rows.is_empty()));
    }
    let swept = sweep_model(&loaded, &certificates, &request, &bar);
    interrupt::check()?;
    let rows = swept.map_err(|error| load::in_file(error.into(), &args.model.path))?;
    print(args, &rows, &certificates, || {
        [vec![ranges.to_string()], sweep_table(&rows, "--q, --ignore-rest")].concat()
    })?;
    // The table says so itself.
    if args.json.json && rows.iter().any(|row| row.outcome == SweepOutcome::CollidingAtStart) {
        note("pairs collide at the start: --ignore-rest leaves out those at rest, --q sets other weights");
    }
    Ok(outcome(rows.iter().all(|row| row.outcome == SweepOutcome::Free)))
}

/// Prints the rows, and which pairs they are apart from, where pairs are ignored.
fn print(
    args: &Sweep,
    rows: &[impl Serialize],
    certificates: &Certificates,
    table: impl Fn() -> Vec<String>,
) -> Result<()> {
    let mut out = Output::new();
    let left_out = LeftOut::of(certificates.filter());
    let apart = (left_out.ignored() > 0).then(|| format!("all of it apart from {left_out}"));
    match args.json.json {
        true => rows.iter().try_for_each(|row| out.json(row))?,
        false => table().into_iter().chain(apart.clone()).try_for_each(|line| out.line(line))?,
    }
    if args.json.json
        && let Some(apart) = apart
    {
        note(apart);
    }
    out.finish()
}

fn outcome(is_free: bool) -> Outcome {
    if is_free { Outcome::Done } else { Outcome::Finding }
}
