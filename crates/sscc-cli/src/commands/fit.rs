//! `sscc fit`: computes the q whose shape is nearest to given positions, by least squares.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use serde::Serialize;
use sscc_io::{FrameReader, write_npy};
use sscc_modes::{DisplacementFit, FittedConfiguration};

use crate::args::Fit;
use crate::outcome::Outcome;
use crate::output::{Output, counted, length, note};
use crate::{interrupt, load};

#[derive(Serialize)]
struct Row {
    index: usize,
    q: Vec<f64>,
    /// Norm of the residual over that of the displacements.
    residual: f64,
    /// The largest distance of a vertex from its given position.
    largest: f64,
    /// The vertex at that distance.
    vertex: u32,
}

pub fn run(args: &Fit) -> Result<Outcome> {
    let files = [&args.model.path, &args.positions];
    let inputs: Vec<&Path> = files.into_iter().chain(&args.model.modes).map(PathBuf::as_path).collect();
    load::check_output(&args.output, ".npy", &inputs)?;
    let loaded = load::model(&args.model)?;
    let (mesh, modes) = (loaded.model.mesh(), loaded.model.modes());
    let frames = FrameReader::open(&args.positions, mesh, &args.model.path)?;
    frames.warnings().iter().for_each(|line| note(format_args!("{}: {line}", args.positions.display())));
    let fit = DisplacementFit::new(modes).with_context(|| args.model.path.display().to_string())?;
    let (mut rows, mut positions) = (Vec::new(), Vec::new());
    for index in 0..frames.len() {
        frames.read(index, &mut positions)?;
        let displacements: Vec<_> =
            positions.iter().zip(mesh.rest_positions()).map(|(x, rest)| *x - *rest).collect();
        let found = fit.fit(&displacements);
        let FittedConfiguration { q, residual, largest, vertex } =
            found.with_context(|| format!("{}: frame {index}", args.positions.display()))?;
        rows.push(Row { index, q, residual, largest, vertex });
        interrupt::check()?;
    }
    let q: Vec<f64> = rows.iter().flat_map(|row| row.q.iter().copied()).collect();
    let shape = [rows.len(), modes.rank()];
    write_npy(&args.output, if rows.len() == 1 { &shape[1..] } else { &shape }, &q)?;
    let mut out = Output::new();
    for row in &rows {
        if args.json.json {
            out.json(row)?;
            continue;
        }
        let Row { index, residual, largest, vertex, .. } = row;
        out.line(format_args!(
            "frame {index:>5}  {:.4}% of the displacements remain, at most {} (vertex {vertex})",
            100.0 * residual,
            length(*largest)
        ))?;
    }
    if !args.json.json {
        let frames = counted(rows.len() as u64, "frame");
        out.line(format_args!("{frames}, counted from 0; written: {}", args.output.display()))?;
    }
    out.finish()?;
    Ok(Outcome::Done)
}
