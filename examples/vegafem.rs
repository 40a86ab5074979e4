//! Measures queries of a VegaFEM model along a trajectory, and shows how a centre helps if the shape moves about
//! another pose than rest.
//!
//! `cargo run --release -p sscc-examples --example vegafem [MESH.obj MODES.U]`
#![allow(clippy::print_stdout)]

use std::env;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;
use std::process::ExitCode;

use sscc::{Certificates, CertifyOptions, Query, ReducedModel};
use sscc_examples::{exit_code, mouth_vegafem};
use sscc_io::load_model;

const FRAMES: usize = 300;

fn main() -> ExitCode {
    exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?; // for the mouth; removed at the end
    let files: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [mesh, modes] = match <[PathBuf; 2]>::try_from(files) {
        Ok(files) => files,
        Err(none) if none.is_empty() => mouth_vegafem(folder.path())?,
        Err(_) => return Err("give a mesh and its modes, or nothing".into()),
    };
    let (model, info) = load_model(&mesh, Some(&modes))?;
    println!("{}: {} triangles, {} modes", info.provenance, model.mesh().faces().len(), model.rank());

    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    println!("certified about rest: free where |z| < {:.3e}", certificates.root_radius());

    // All modes swing with growing amplitude, up to the |z| at which mode 0 alone moves some vertex by half the size of the
    // shape. (By default radii end there; local certificates may prove shapes beyond.)
    let rest = vec![0.0; model.rank()];
    let mut far = rest.clone();
    far[0] = half_size(&model);
    if far[0].is_infinite() {
        println!("mode 0 moves nothing");
        return Ok(());
    }
    let largest = model.metric().norm(&far)?;
    let growing = (0..FRAMES).map(|i| swing(&model, &rest, i, largest * i as f64 / FRAMES as f64));
    let mut query = Query::new(&model, &certificates)?;
    check("growing", &mut query, growing)?;

    // The shape may have settled in another pose, for example under its weight. Here mode 0 has half of the amplitude above,
    // in the negative direction, or half of the safe scale if that is less. The shape swings about this pose with a small
    // amplitude.
    let mut settled = rest.clone();
    settled[0] = -far[0];
    let safe = query.safe_scale(&settled)?;
    if safe == 0.0 {
        println!("no other pose to settle in: the shape collides at rest");
        return Ok(());
    }
    settled[0] *= safe.min(1.0) / 2.0;
    let size = 0.3 * certificates.root_radius();
    let small = || (0..FRAMES).map(|i| swing(&model, &settled, i, size));
    check("settled", &mut query, small())?;

    // Certificates with that pose as centre measure |z| from there.
    let options = CertifyOptions::default().center(settled.clone());
    let centred = Certificates::compute(&model, &options, &())?;
    println!("certified about the settled pose: free where |z| < {:.3e}", centred.root_radius());
    check("settled", &mut Query::new(&model, &centred)?, small())?;
    Ok(())
}

/// Returns the amplitude of mode 0 at which some vertex has moved by half the diagonal of the AABB at rest.
fn half_size(model: &ReducedModel) -> f64 {
    let positions = model.mesh().rest_positions();
    let (low, high) = positions.iter().fold((positions[0], positions[0]), |(l, h), p| (l.min(*p), h.max(*p)));
    let vertices = 0..positions.len() as u32;
    let farthest = vertices.map(|v| model.modes().of_vertex(v)[0].length()).fold(0.0, f64::max);
    (high - low).length() / 2.0 / farthest
}

/// Returns frame i of an oscillation about a pose, at the distance `size` from it in the model's metric. Every mode has
/// its own frequency.
fn swing(model: &ReducedModel, about: &[f64], i: usize, size: f64) -> Result<Vec<f64>, sscc::Error> {
    let time = i as f64 / FRAMES as f64;
    let turns = |k: usize| (3.0 + 0.7 * k as f64) * time + 0.13 * (1 + k) as f64;
    let z: Vec<f64> = (0..model.rank()).map(|k| libm::sin(TAU * turns(k)) / (1 + k) as f64).collect();
    let length = z.iter().map(|x| x * x).sum::<f64>().sqrt();
    let offset = model.metric().unscaled(&z)?;
    Ok(about.iter().zip(offset).map(|(q, d)| q + d * size / length).collect())
}

/// Queries every frame, and prints the mean cost.
fn check(
    name: &str,
    query: &mut Query,
    frames: impl Iterator<Item = Result<Vec<f64>, sscc::Error>>,
) -> Result<(), sscc::Error> {
    let (mut colliding, mut by_root, mut opened, mut boxes, mut triangles) = (0, 0, 0, 0, 0);
    for q in frames {
        colliding += usize::from(!query.discrete(&q?)?.is_empty());
        let cost = query.statistics();
        by_root += usize::from(cost.root_certified);
        opened += cost.opened;
        boxes += cost.box_tests;
        triangles += cost.triangle_tests;
    }
    println!("{name}: {FRAMES} frames, {colliding} colliding, {by_root} answered by one comparison");
    let mean = |sum: u64| sum as f64 / FRAMES as f64;
    println!(
        "    a frame opens {:.1} nodes, makes {:.1} AABB tests and tests {:.1} triangle pairs",
        mean(opened),
        mean(boxes),
        mean(triangles)
    );
    Ok(())
}
