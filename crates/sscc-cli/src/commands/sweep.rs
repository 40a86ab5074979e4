//! `sscc sweep`: for each mode the first weight at which the shape touches itself.

use anyhow::Result;
use sscc::SweepOutcome;
use sscc_sim::{SweepRequest, sweep_model, sweep_table};

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
    let certificates = match &args.certificates {
        Some(path) => load::request(&loaded, &args.model, &args.options)?.read(path, &loaded.model)?,
        None => load::certificates_now(&loaded, &args.model, &args.options)?,
    };
    let swept = sweep_model(&loaded, &certificates, &request, &Bar::new("sweeping"));
    interrupt::check()?;
    let rows = swept.map_err(|error| load::in_file(error.into(), &args.model.path))?;
    let mut out = Output::new();
    match args.json.json {
        true => rows.iter().try_for_each(|row| out.json(row))?,
        false => {
            out.line(request.ranges(&loaded)?)?;
            sweep_table(&rows, "--q, --ignore-rest").into_iter().try_for_each(|line| out.line(line))?;
        }
    }
    out.finish()?;
    // The table says so itself.
    if args.json.json && rows.iter().any(|row| row.outcome == SweepOutcome::CollidingAtStart) {
        note("pairs collide at the start: --ignore-rest leaves out those at rest, --q sets other weights");
    }
    let is_free = rows.iter().all(|row| row.outcome == SweepOutcome::Free);
    Ok(if is_free { Outcome::Done } else { Outcome::Finding })
}
