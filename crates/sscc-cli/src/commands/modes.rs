//! `sscc modes`: a mesh becomes a model.

use anyhow::Context;
use serde::Serialize;
use sscc::ReducedModel;
use sscc_io::{ModelInfo, read_mesh, write_model};
use sscc_modes::polynomial_modes;

use crate::args::{Modes, ModesKind};
use crate::output::{Output, grouped};
use crate::{Outcome, interrupt, load};

#[derive(Serialize)]
struct Report {
    triangles: usize,
    vertices: usize,
    rank: usize,
}

pub fn run(args: &Modes) -> anyhow::Result<Outcome> {
    load::check_output(&args.output, ".model.safetensors", &[&args.source])?;
    let mesh = read_mesh(&args.source)?;
    let in_source = || args.source.display().to_string();
    let modes = match args.kind {
        ModesKind::Polynomial => polynomial_modes(&mesh).with_context(in_source)?,
    };
    let model = ReducedModel::new(mesh, modes).with_context(in_source)?;
    let name = args.source.file_name().unwrap_or_default().to_string_lossy();
    interrupt::check()?;
    write_model(&args.output, &model, &ModelInfo::new("", format!("mesh {name}, polynomial modes")))?;

    let report = Report {
        triangles: model.mesh().faces().len(),
        vertices: model.mesh().rest_positions().len(),
        rank: model.rank(),
    };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let Report { triangles, vertices, rank } = report;
        let (triangles, vertices) = (grouped(triangles as u64), grouped(vertices as u64));
        out.line(format_args!("{triangles} triangles, {vertices} vertices, {rank} polynomial modes"))?;
        out.line(format_args!("written: {}", args.output.display()))?;
    }
    out.finish()?;
    if sscc_io::splits_vertices(&args.source) {
        eprintln!("note: this format splits vertices: certify it with --weld");
    }
    Ok(Outcome::Done)
}
