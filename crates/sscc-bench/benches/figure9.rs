//! Draws the paper's Figure 9: the root's radius of the spring over the number of modes, under two metrics.
//! `cargo bench -p sscc-bench --bench figure9` prints a table and draws `docs/figure9.svg`.
//!
//! Both metrics are scaled so that the first mode's weight is 1. The root's radius is then the largest deformation
//! along the first mode alone that is proven free.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::fmt::Write;

use sscc::{Certificates, CertifyOptions, Metric, Modes, ReducedModel};
use sscc_modes::{EmbeddedSurface, energy_metric, linear_modes, shapes::spring};
use sscc_solid::Material;

/// Any error ends the bench.
type Result<T> = std::result::Result<T, Box<dyn Error>>;

const RANKS: [usize; 5] = [5, 10, 20, 40, 80];

/// Largest displacement by the first mode (mm) that the root's certificate allows.
struct Row {
    rank: usize,
    displacement: f64,
    energy: f64,
}

fn main() -> Result<()> {
    let mesh = spring();
    let body = EmbeddedSurface::new(&mesh, None, Material::default(), &())?;
    let found = linear_modes(body.solid(), &[], *RANKS.last().ok_or("ranks")?, &())?;
    let (all, eigenvalues) = (body.on_surface(&found.modes)?, found.eigenvalues());
    let first = all.displacements().iter().step_by(all.rank()).map(|u| u.length()).fold(0.0, f64::max);
    println!("| modes | displacement metric, mm | energy metric, mm |");
    println!("| --- | --- | --- |");
    let mut rows = Vec::new();
    for rank in RANKS {
        let columns = |v: usize| &all.displacements()[v * all.rank()..][..rank];
        let modes = Modes::new(rank, (0..all.vertices()).flat_map(columns).copied().collect())?;
        let model = ReducedModel::new(mesh.clone(), modes)?;
        let root = |metric: Metric| -> Result<f64> {
            let scale = metric.scales()[0];
            let options = CertifyOptions::default().metric(metric);
            let certificates = Certificates::compute(&model, &options, &())?;
            Ok(1e3 * first * certificates.root_radius() / scale)
        };
        let displacement = root(model.metric().clone())?;
        let row = Row { rank, displacement, energy: root(energy_metric(&eigenvalues[..rank])?)? };
        println!("| {rank} | {:.2} | {:.2} |", row.displacement, row.energy);
        rows.push(row);
    }
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/figure9.svg");
    Ok(sscc_io::write_whole(file.as_ref(), plot(&rows)?.as_bytes())?)
}

/// Returns the plot of both curves over the rank.
fn plot(rows: &[Row]) -> Result<String> {
    let (width, height, left, top) = (560.0, 340.0, 60.0, 50.0);
    let max = rows.iter().map(|r| r.energy.max(r.displacement)).fold(0.0, f64::max);
    let lines = (max / 5.0).ceil();
    let x = |rank: f64| left + (rank / 5.0).log2() / 4.0 * (width - left - 130.0);
    let y = |mm: f64| top + (1.0 - mm / (5.0 * lines)) * (height - top - 60.0);
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">"
    )?;
    writeln!(svg, "<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>")?;
    writeln!(svg, "<text x=\"{left}\" y=\"26\">Spring: proven free along the first mode, up to</text>")?;
    for line in 0..=lines as u32 {
        let mm = 5 * line;
        let at = y(f64::from(mm));
        writeln!(svg, "<path d=\"M{left} {at:.1}H{:.1}\" stroke=\"#ddd\"/>", x(80.0))?;
        writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{mm} mm</text>", left - 8.0, at + 4.0)?;
    }
    for rank in RANKS {
        let at = x(rank as f64);
        writeln!(svg, "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{rank}</text>", height - 36.0)?;
    }
    writeln!(svg, "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">modes</text>", x(20.0), height - 14.0)?;
    let energy: Vec<f64> = rows.iter().map(|r| r.energy).collect();
    let displacement: Vec<f64> = rows.iter().map(|r| r.displacement).collect();
    for (name, color, values) in
        [("energy metric", "#0b6bb8", energy), ("displacement", "#c4501b", displacement)]
    {
        let at = |(row, mm): (&Row, &f64)| format!("{:.1},{:.1}", x(row.rank as f64), y(*mm));
        let points: Vec<String> = rows.iter().zip(&values).map(at).collect();
        writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\"/>",
            points.join(" ")
        )?;
        for point in &points {
            let (cx, cy) = point.split_once(',').ok_or("a point")?;
            writeln!(svg, "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"3.5\" fill=\"{color}\"/>")?;
        }
        let last = values.last().ok_or("rows")?;
        writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{color}\">{name}</text>",
            x(80.0) + 10.0,
            y(*last) + 4.0
        )?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}
