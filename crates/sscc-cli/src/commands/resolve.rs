//! `sscc resolve`: finds a free q near each colliding q.

use anyhow::{Result, ensure};
use serde::Serialize;
use sscc::{Query, ResolveOptions};
use sscc_sim::configuration;

use super::check::coordinates;
use crate::args::Resolve;
use crate::outcome::Outcome;
use crate::output::{Output, length, note};
use crate::progress::Bar;
use crate::{interrupt, load};

#[derive(Serialize)]
struct Report {
    resolved: bool,
    q: Option<Vec<f64>>,
    change: f64,
    safe_scale_change: f64,
}

pub fn run(args: &Resolve) -> Result<Outcome> {
    ensure!(args.at.q.is_some() || args.at.trajectory.is_some(), "--q or --trajectory is needed");
    let model = load::model(&args.model)?.model;
    let rows = coordinates(&args.at, &model)?;
    let start = args.from.as_deref().map(|typed| configuration(&model, "--from", typed)).transpose()?;
    let certificates = match &args.certificates {
        Some(path) => load::request(&args.model, &args.options).read(path, &model)?,
        None => load::certificates_now(&model, &args.model, &args.options)?,
    };
    let options = ResolveOptions { start, all: args.all };
    let threads = Some(load::threads(&args.options.threads));
    let rows: Vec<&[f64]> = rows.iter().collect();
    let bar = Bar::new("resolving");
    let found = Query::new(&model, &certificates)?.resolve_batch(&rows, &options, threads, &bar);
    drop(bar);
    interrupt::check()?;
    let (mut out, mut unresolved) = (Output::new(), 0);
    for found in found? {
        let report = Report {
            resolved: found.is_resolved(),
            q: found.q,
            change: found.change,
            safe_scale_change: found.safe_scale_change,
        };
        unresolved += usize::from(!report.resolved);
        if args.json.json {
            out.json(&report)?;
            continue;
        }
        out.line(match &report.q {
            None => "NOT RESOLVED".to_owned(),
            Some(_) if report.change == 0.0 => "free as it is".to_owned(),
            Some(q) => format!(
                "resolved  change |z| {}, stepping back {}  q = {q:?}",
                length(report.change),
                length(report.safe_scale_change)
            ),
        })?;
    }
    out.finish()?;
    if unresolved > 0 {
        note("the centre collides: give a free start by --from, or certificates about a free centre");
    }
    Ok(if unresolved == 0 { Outcome::Done } else { Outcome::Finding })
}
