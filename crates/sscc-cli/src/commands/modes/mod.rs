//! `sscc modes`: makes a model from a surface, a solid or the frames of an animation.

mod make;
mod material;

use std::path::Path;

use anyhow::Result;
use serde::Serialize;
use sscc_io::write_model;
use sscc_tasks::text::size_and_mass;
use sscc_tasks::{Components, has_equal_vertices, longest_side};

use crate::args;
use crate::outcome::Outcome;
use crate::output::{Output, counted, grouped, length, note};
use crate::{interrupt, load};
use make::make;

#[derive(Serialize)]
struct Report {
    triangles: usize,
    vertices: usize,
    rank: usize,
    /// Longest side of the box around the surface (m).
    longest_side: f64,
    /// Mass of the solid (kg).
    #[serde(skip_serializing_if = "Option::is_none")]
    mass: Option<f64>,
    /// Tetrahedra and cubes of the solid; absent without a solid.
    #[serde(skip_serializing_if = "Option::is_none")]
    elements: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    degrees_of_freedom: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequencies_hz: Option<Vec<f64>>,
    /// First frequency of the same tetrahedra in second order.
    #[serde(skip_serializing_if = "Option::is_none")]
    second_order_hz: Option<f64>,
    #[serde(flatten)]
    components: Option<Components>,
}

/// Maximum excess of the first frequency (percent) for which no note is printed.
const MAX_EXCESS: f64 = 5.0;

pub fn run(args: &args::Modes) -> Result<Outcome> {
    let inputs: Vec<&Path> =
        [&args.source].into_iter().chain(&args.solid).map(|path| path.as_path()).collect();
    load::check_output(&args.output, ".model.safetensors", &inputs)?;
    let made = make(args)?;
    interrupt::check()?;
    let model = &made.model;
    write_model(&args.output, model, &made.info)?;

    let report = Report {
        triangles: model.mesh().faces().len(),
        vertices: model.mesh().rest_positions().len(),
        rank: model.rank(),
        longest_side: longest_side(model.mesh().rest_positions()),
        mass: made.solid.as_ref().map(|solid| solid.mass),
        elements: made.solid.as_ref().map(|solid| solid.elements),
        degrees_of_freedom: made.solid.as_ref().map(|solid| solid.degrees_of_freedom),
        frequencies_hz: made.solid.as_ref().map(|solid| solid.frequencies.clone()),
        second_order_hz: made.solid.as_ref().and_then(|solid| solid.second_order),
        components: made.components.clone(),
    };
    let mut out = Output::new();
    if args.json.json {
        out.json(&report)?;
    } else {
        let kind = args.kind.name();
        let (triangles, vertices) = (grouped(report.triangles as u64), grouped(report.vertices as u64));
        let modes = match &report.components {
            None => format!("{} {kind} modes", report.rank),
            Some(Components { frames, explained, .. }) => format!(
                "{} of {frames} frames ({:.2}% of the variance)",
                counted(report.rank as u64, "principal component"),
                100.0 * explained
            ),
        };
        out.line(format_args!("{triangles} triangles, {vertices} vertices, {modes}"))?;
        if let (Some(elements), Some(freedom)) = (report.elements, report.degrees_of_freedom) {
            let elements = counted(elements as u64, "element");
            out.line(format_args!("solid of {elements}, {} degrees of freedom", grouped(freedom as u64)))?;
        }
        match (report.mass, report.frequencies_hz.as_deref()) {
            (Some(mass), Some([first, ..])) => {
                out.line(size_and_mass(report.longest_side, Some(mass), *first))?;
            }
            _ => out.line(format_args!("longest side {} m", length(report.longest_side)))?,
        }
        if let Some([first, .., last]) = report.frequencies_hz.as_deref() {
            out.line(format_args!("frequencies from {} to {} Hz", length(*first), length(*last)))?;
        }
        out.line(format_args!("written: {}", args.output.display()))?;
    }
    out.finish()?;
    if let (Some([first, ..]), Some(second_order)) =
        (report.frequencies_hz.as_deref(), report.second_order_hz)
    {
        let excess = 100.0 * (first / second_order - 1.0);
        if excess > MAX_EXCESS {
            note(format_args!(
                "the tetrahedra are too stiff: the first frequency is {excess:.0}% above that of the same ones in second \
                 order ({} Hz); mesh the solid in second order (gmsh: -order 2) or finer",
                length(second_order)
            ));
        }
    }
    if has_equal_vertices(model) {
        note("some vertices have equal positions and modes, as along seams: certify the model with --weld");
    }
    Ok(Outcome::Done)
}
