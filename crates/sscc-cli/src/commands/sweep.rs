//! `sscc sweep`: for each mode the first weight at which the shape touches itself, or all intervals in which it collides;
//! combinations of two modes.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use sscc::{Certificates, SweepOutcome};
use sscc_io::{LoadedModel, write_whole};
use sscc_tasks::{
    IntervalRow, LeftOut, SweepRequest, combination_table, interval_table, sweep_model,
    sweep_model_combinations, sweep_model_intervals, sweep_table,
};

use sscc_view::{Axis, MAX_REPORT_BYTES, Plot, Report, Scene, Series};

use crate::args::Sweep;
use crate::model_scene::model_scene;
use crate::outcome::Outcome;
use crate::output::{Output, file_name, note};
use crate::progress::Bar;
use crate::{interrupt, load};

pub fn run(args: &Sweep) -> Result<Outcome> {
    let loaded = load::model(&args.model)?;
    let threads = Some(load::threads(&args.options.threads));
    let Sweep { q, range, pose, .. } = args;
    let request = SweepRequest { q: q.clone(), range: range.clone(), pose: pose.clone(), threads };
    // Unusable outputs are refused before certificates are computed.
    if let Some(report) = &args.report {
        load::check_output(report, ".html", &[&args.model.path])?;
    }
    check_poses(args)?;
    request.prepare(&loaded, &vec![0.0; loaded.model.rank()])?;
    let ranges = request.ranges(&loaded)?;
    let certificates = match &args.certificates {
        Some(path) => load::request(&loaded, &args.model, &args.options)?.read(path, &loaded.model)?,
        None => load::certificates_now(&loaded, &args.model, &args.options)?,
    };
    let bar = Bar::new("sweeping");
    if let Some(samples) = args.intervals {
        let found = sweep_model_intervals(&loaded, &certificates, &request, samples as usize, &bar);
        interrupt::check()?;
        let rows = found.map_err(|error| load::in_file(error.into(), &args.model.path))?;
        print(args, &rows, &certificates, || [vec![ranges.to_string()], interval_table(&rows)].concat())?;
        if let Some(report) = &args.report {
            let (q, _) = request.prepare(&loaded, certificates.center())?;
            write_report(report, &args.model.path, &loaded, &certificates, (q, &rows))?;
        }
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
    // Given certificates refuse --ignore-rest unless they were computed with it.
    let (remedy, ignore_rest) = match args.certificates {
        Some(_) => ("--q, certificates with --ignore-rest", "certificates with --ignore-rest leave"),
        None => ("--q, --ignore-rest", "--ignore-rest leaves"),
    };
    print(args, &rows, &certificates, || [vec![ranges.to_string()], sweep_table(&rows, remedy)].concat())?;
    // The table itself states this.
    if args.json.json && rows.iter().any(|row| row.outcome == SweepOutcome::CollidingAtStart) {
        note(format_args!(
            "pairs collide at the start: {ignore_rest} out those at rest, --q sets other weights"
        ));
    }
    Ok(outcome(rows.iter().all(|row| row.outcome == SweepOutcome::Free)))
}

/// Refuses poses in the folder of the target meshes: they would be modes of the next run.
fn check_poses(args: &Sweep) -> Result<()> {
    let (Some(poses), Some(modes)) = (&args.pose, &args.model.modes) else { return Ok(()) };
    let is_one = match [poses, modes].map(fs::canonicalize) {
        [Ok(poses), Ok(modes)] => poses == modes && modes.is_dir(),
        _ => false,
    };
    ensure!(
        !is_one,
        "{}: the poses would be target meshes of --modes; choose another folder",
        poses.display()
    );
    Ok(())
}

/// Writes the page with the model at q, its intervals along the sliders, and the curve of the depth over each weight
/// that has intervals.
fn write_report(
    report: &Path,
    model: &Path,
    loaded: &LoadedModel,
    certificates: &Certificates,
    (q, rows): (Vec<f64>, &[IntervalRow]),
) -> Result<()> {
    let in_report = || report.display().to_string();
    let name = file_name(model);
    let (described, arrays) = model_scene(loaded, certificates, &name, Some(q)).with_context(in_report)?;
    let mut scene = Scene::new(&name);
    scene.models.push(described.with_intervals(rows.to_vec()));
    let colliding = rows.iter().filter(|row| !row.intervals.is_empty());
    scene.plots.extend(colliding.clone().map(|row| Plot {
        title: format!("penetration depth, {}", row.name),
        x: Axis::linear("weight"),
        y: Axis::linear("depth (model unit)"),
        series: vec![Series::new(
            "largest depth of a pair",
            row.samples.iter().map(|(x, _, depth)| [*x, *depth]),
        )],
    }));
    let free = rows.len() - colliding.count();
    scene.summary = vec![
        ("modes".into(), rows.len().to_string()),
        ("free over their whole range".into(), free.to_string()),
        ("samples of each weight".into(), rows.first().map_or(0, |row| row.samples.len()).to_string()),
        ("not tested".into(), LeftOut::of(certificates.filter()).to_string()),
    ];
    let html = Report { scene, arrays, checks: None }.html().with_context(in_report)?;
    ensure!(
        html.len() as u64 <= MAX_REPORT_BYTES,
        "{}: the page would have more than {} MiB: sweep a model with fewer vertices or modes, or see sscc view",
        report.display(),
        MAX_REPORT_BYTES >> 20
    );
    Ok(write_whole(report, html.as_bytes())?)
}

/// Prints the rows, and the pairs that no sweep tested, where pairs are ignored.
fn print(
    args: &Sweep,
    rows: &[impl Serialize],
    certificates: &Certificates,
    table: impl Fn() -> Vec<String>,
) -> Result<()> {
    let mut out = Output::new();
    let left_out = LeftOut::of(certificates.filter());
    let untested = (left_out.ignored() > 0).then(|| format!("not tested: {left_out}"));
    match args.json.json {
        true => rows.iter().try_for_each(|row| out.json(row))?,
        false => table().into_iter().chain(untested.clone()).try_for_each(|line| out.line(line))?,
    }
    if args.json.json
        && let Some(untested) = untested
    {
        note(untested);
    }
    out.finish()
}

fn outcome(is_free: bool) -> Outcome {
    if is_free { Outcome::Done } else { Outcome::Finding }
}
