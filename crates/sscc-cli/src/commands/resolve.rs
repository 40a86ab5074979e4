//! `sscc resolve`: finds a free q near each colliding q.

use std::ops::ControlFlow;

use anyhow::{Result, ensure};
use serde::Serialize;
use sscc::ResolveOptions;
use sscc_io::{LoadedModel, Setting};
use sscc_tasks::{ResolveReport, TaskError, read_configuration, resolve_rows};

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
    let bar = Bar::new("resolving");
    // Where every row is printed, the rows show the progress.
    let is_listing = args.at.trajectory.is_some() && !args.only.is_colliding();
    let bar = if is_listing { bar.beside_output() } else { bar };
    let (mut out, mut summary) = (Output::new(), Summary::default());
    let take = |index: usize, report: ResolveReport| {
        summary.add(index, &report);
        if !args.only.is_colliding() || !report.is_free_as_given() {
            print(&mut out, args, &loaded, index, &report)?;
            // The next row may take minutes.
            out.flush()?;
        }
        Ok(if out.is_closed() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    };
    let resolved: Result<()> = resolve_rows(model, &certificates, &rows, &options, threads, &bar, take);
    drop(bar);
    interrupt::check()?;
    // All other arguments were checked before, so an error of the task is about the start.
    resolved.map_err(|error| if error.is::<TaskError>() { error.context("--from") } else { error })?;
    if !args.json.json && (args.at.trajectory.is_some() || args.only.is_colliding()) {
        out.line(summary.line())?;
    }
    out.finish()?;
    let is_done = summary.failed == 0;
    if !is_done {
        note("give a free start by --from, or certificates about a free centre");
    }
    Ok(if is_done { Outcome::Done } else { Outcome::Finding })
}

/// Prints the report of a row.
fn print(
    out: &mut Output,
    args: &Resolve,
    loaded: &LoadedModel,
    index: usize,
    report: &ResolveReport,
) -> Result<()> {
    match (args.json.json, args.at.trajectory.is_some()) {
        (true, _) if args.only.is_colliding() => out.json(&Row { index, report }),
        (true, _) => out.json(report),
        (false, true) => out.line(format_args!("row {index:>5}  {report}")),
        (false, false) => {
            let q = report.q.as_deref().filter(|_| !report.is_free_as_given());
            let q = q.map(|q| {
                format!("q (rounded; --json prints all digits): {}", rounded(q, &loaded.mode_names))
            });
            [Some(report.to_string()), q].into_iter().flatten().try_for_each(|line| out.line(line))
        }
    }
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

/// Counts of the rows so far, and the one with the largest change.
#[derive(Default)]
struct Summary {
    rows: usize,
    free: usize,
    failed: usize,
    /// The row and its change.
    largest: Option<(usize, f64)>,
}

impl Summary {
    fn add(&mut self, index: usize, report: &ResolveReport) {
        self.rows += 1;
        if !report.resolved {
            self.failed += 1;
        } else if report.is_free_as_given() {
            self.free += 1;
        } else if self.largest.is_none_or(|(_, change)| report.change > change) {
            self.largest = Some((index, report.change));
        }
    }

    fn line(&self) -> String {
        let Self { rows, free, failed, largest } = *self;
        let resolved = rows - free - failed;
        let largest =
            largest.map(|(index, change)| format!("; worst: row {index} (change {})", length(change)));
        format!(
            "{}: {free} free as given, {resolved} resolved, {failed} not resolved{}; rows are counted from 0; --json prints each free q",
            counted(rows as u64, "row"),
            largest.unwrap_or_default()
        )
    }
}
