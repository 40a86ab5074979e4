//! `sscc load`: computes the linear static q of a model under a load.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use serde::Serialize;
use sscc_io::write_npy;
use sscc_tasks::{longest_side, static_answer};

use crate::args::Load;
use crate::load;
use crate::outcome::Outcome;
use crate::output::{Output, length, note};

/// Largest displacement, as a share of the longest side, for which no note is printed.
const MAX_LINEAR: f64 = 0.1;

#[derive(Serialize)]
struct Report {
    q: Vec<f64>,
    /// The largest displacement of a vertex (m).
    largest_displacement: f64,
    /// The vertex with that displacement.
    vertex: u32,
}

pub fn run(args: &Load) -> Result<Outcome> {
    ensure!(!args.force.is_empty() || args.gravity.is_some(), "--force or --gravity is needed");
    let inputs: Vec<&Path> =
        [&args.model.path].into_iter().chain(&args.model.modes).map(PathBuf::as_path).collect();
    load::check_output(&args.output, ".npy", &inputs)?;
    let loaded = load::model(&args.model)?;
    let found = static_answer(&loaded.model, &loaded.info, &args.force, args.gravity);
    let found = found.map_err(|error| load::in_file(error.into(), &args.model.path))?;
    write_npy(&args.output, &[found.q.len()], &found.q)?;
    let report = Report { q: found.q, largest_displacement: found.largest, vertex: found.vertex };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let (largest, vertex) = (length(report.largest_displacement), report.vertex);
        out.line(format_args!("largest displacement {largest} m, of vertex {vertex}"))?;
        out.line(format_args!("written: {}", args.output.display()))?;
    }
    out.finish()?;
    let share = report.largest_displacement / longest_side(loaded.model.mesh().rest_positions());
    if share > MAX_LINEAR {
        note(format_args!(
            "the answer is linear, and a displacement of {:.0}% of the longest side is too large for it",
            100.0 * share
        ));
    }
    Ok(Outcome::Done)
}
