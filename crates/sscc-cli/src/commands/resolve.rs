//! `sscc resolve`: finds a free q near each colliding q.

use anyhow::{Context, Result, ensure};
use sscc::ResolveOptions;
use sscc_sim::{read_configuration, resolve_rows};

use super::check::coordinates;
use crate::args::Resolve;
use crate::outcome::Outcome;
use crate::output::{Output, note};
use crate::progress::Bar;
use crate::{interrupt, load};

pub fn run(args: &Resolve) -> Result<Outcome> {
    ensure!(args.at.q.is_some() || args.at.trajectory.is_some(), "--q or --trajectory is needed");
    let loaded = load::model(&args.model)?;
    let model = &loaded.model;
    let rows = coordinates(&args.at, &loaded)?;
    let start = args.from.as_deref().map(|typed| read_configuration("--from", typed, &loaded)).transpose()?;
    let certificates = match &args.certificates {
        Some(path) => load::request(&loaded, &args.model, &args.options)?.read(path, model)?,
        None => load::certificates_now(&loaded, &args.model, &args.options)?,
    };
    let options = ResolveOptions { start, all: args.all };
    let threads = load::threads(&args.options.threads);
    let found = resolve_rows(model, &certificates, &rows, &options, threads, &Bar::new("resolving"));
    interrupt::check()?;
    // All else was checked before.
    let found = found.context("--from")?;
    let mut out = Output::new();
    for report in &found {
        if args.json.json { out.json(report)? } else { out.line(report)? }
    }
    out.finish()?;
    let is_done = found.iter().all(|report| report.resolved);
    if !is_done {
        note("give a free start by --from, or certificates about a free centre");
    }
    Ok(if is_done { Outcome::Done } else { Outcome::Finding })
}
