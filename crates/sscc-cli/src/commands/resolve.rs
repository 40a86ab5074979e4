//! `sscc resolve`: finds a free q near each colliding q.

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use sscc::ResolveOptions;
use sscc_io::Setting;
use sscc_tasks::{ResolveReport, read_configuration, resolve_rows};

use super::check::coordinates;
use crate::args::Resolve;
use crate::outcome::Outcome;
use crate::output::{Output, counted, length, note, one_line};
use crate::progress::Bar;
use crate::{interrupt, load};

/// The largest number of entries of q in the text; `--json` prints all.
const MAX_LISTED: usize = 24;

/// A report with the number of its row, because not all rows may be printed.
#[derive(Serialize)]
struct Row<'a> {
    index: usize,
    #[serde(flatten)]
    report: &'a ResolveReport,
}

pub fn run(args: &Resolve) -> Result<Outcome> {
    ensure!(args.at.q.is_some() || args.at.trajectory.is_some(), "--q or --trajectory is needed");
    let loaded = load::model(&args.model)?;
    let model = &loaded.model;
    let rows = coordinates(&args.at, &loaded)?;
    let start =
        args.from.as_deref().map(|typed| read_configuration(Setting::From, typed, &loaded)).transpose()?;
    let certificates = match &args.certificates {
        Some(path) => load::request(&loaded, &args.model, &args.options)?.read(path, model)?,
        None => load::certificates_now(&loaded, &args.model, &args.options)?,
    };
    let options = ResolveOptions::default().start(start).all(args.all);
    let threads = load::threads(&args.options.threads);
    let found = resolve_rows(model, &certificates, &rows, &options, threads, &Bar::new("resolving"));
    interrupt::check()?;
    // All other arguments were checked before, so an error is about the start.
    let found = found.context("--from")?;
    let mut out = Output::new();
    let is_listed = |report: &ResolveReport| !args.only.is_colliding() || !report.is_free_as_given();
    for (index, report) in found.iter().enumerate().filter(|(_, report)| is_listed(report)) {
        match (args.json.json, args.at.trajectory.is_some()) {
            (true, _) if args.only.is_colliding() => out.json(&Row { index, report })?,
            (true, _) => out.json(report)?,
            (false, true) => out.line(format_args!("row {index:>5}  {report}"))?,
            (false, false) => {
                let q = report.q.as_deref().filter(|_| !report.is_free_as_given());
                let q = q.map(|q| {
                    format!("q (rounded; --json prints all digits): {}", rounded(q, &loaded.mode_names))
                });
                [Some(report.to_string()), q].into_iter().flatten().try_for_each(|line| out.line(line))?;
            }
        }
    }
    if !args.json.json && (args.at.trajectory.is_some() || args.only.is_colliding()) {
        out.line(summary(&found))?;
    }
    out.finish()?;
    let is_done = found.iter().all(|report| report.resolved);
    if !is_done {
        note("give a free start by --from, or certificates about a free centre");
    }
    Ok(if is_done { Outcome::Done } else { Outcome::Finding })
}

/// Returns q with four digits: the entries of named modes that are not 0, or all entries.
fn rounded(q: &[f64], names: &[String]) -> String {
    let entries: Vec<String> = if names.is_empty() {
        q.iter().map(|entry| length(*entry)).collect()
    } else {
        let moved = q.iter().zip(names).filter(|(entry, _)| **entry != 0.0);
        moved.map(|(entry, name)| format!("{}={}", one_line(name), length(*entry))).collect()
    };
    match entries.len() {
        0 => "0".into(),
        n if n > MAX_LISTED => format!("{}, and {} more", entries[..MAX_LISTED].join(", "), n - MAX_LISTED),
        _ => entries.join(", "),
    }
}

/// Returns the line that counts the rows and names the one with the largest change.
fn summary(found: &[ResolveReport]) -> String {
    let free = found.iter().filter(|report| report.is_free_as_given()).count();
    let failed = found.iter().filter(|report| !report.resolved).count();
    let resolved = found.len() - free - failed;
    let changed =
        found.iter().enumerate().filter(|(_, report)| report.resolved && !report.is_free_as_given());
    let largest = changed.max_by(|a, b| a.1.change.total_cmp(&b.1.change).then(b.0.cmp(&a.0)));
    let largest =
        largest.map(|(index, report)| format!("; worst: row {index} (change {})", length(report.change)));
    format!(
        "{}: {free} free as given, {resolved} resolved, {failed} not resolved{}; rows are counted from 0; --json prints each free q",
        counted(found.len() as u64, "row"),
        largest.unwrap_or_default()
    )
}
