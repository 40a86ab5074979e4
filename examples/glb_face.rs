//! At which weight does each morph target make a face touch itself?
//!
//! `cargo run --release -p sscc-examples --example glb_face [FACE.glb [MESH]]`
#![allow(clippy::print_stdout)]

use std::env;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use sscc::{Certificates, CertifyOptions, ContactFilter, Neighbours, Query};
use sscc_examples::{exit_code, mouth_glb};
use sscc_io::{LoadOptions, load_model_with, write_ply_pose};

/// Weights from 0 to 1 in so many steps.
const STEPS: u32 = 200;

fn main() -> ExitCode {
    exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?; // for the mouth; removed at the end
    let mut arguments = env::args().skip(1);
    let file = match arguments.next() {
        Some(file) => PathBuf::from(file),
        None => mouth_glb(folder.path())?,
    };
    let mesh_name = arguments.next(); // needed where several meshes have morph targets

    let loaded = load_model_with(&file, &LoadOptions::new(None, mesh_name.as_deref()))?;
    let model = loaded.model;
    println!("{}: {} triangles", loaded.info.provenance, model.mesh().faces().len());

    // A glTF file splits vertices along seams: without welding, triangles on the two sides of a seam would
    // share no vertex, and so would always collide. What collides at rest (closed lips, eyes in their
    // sockets) is not what is asked here: these pairs are left out.
    let filter = ContactFilter::new(Neighbours::Exclude, true);
    let options = CertifyOptions { filter, ignore_rest: true, ..CertifyOptions::default() };
    let certificates = Certificates::compute(&model, &options, &())?;
    println!("left out because they collide at rest: {} pairs", certificates.rest_collisions());

    let mut query = Query::new(&model, &certificates)?;
    let mut first_pose = None;
    for (k, name) in loaded.mode_names.iter().enumerate() {
        let at = |weight: f64| {
            let mut q = vec![0.0; model.rank()];
            q[k] = weight;
            q
        };
        // How far the target can be driven: proven for every weight on the way, so the sweep starts there.
        let safe = query.safe_scale(&at(1.0))?;
        let weights = (0..=STEPS).map(|step| f64::from(step) / f64::from(STEPS));
        let mut touch = None;
        for weight in weights.filter(|weight| *weight >= safe) {
            if let Some(pair) = query.first(&at(weight))? {
                touch = Some((weight, pair));
                break;
            }
        }
        print!("{name:>12}: proven free up to {safe:.4}, ");
        match touch {
            Some((weight, (i, j))) => println!("first touch found at {weight}: triangles {i} and {j}"),
            None => println!("no touch found up to 1"),
        }
        if let (None, Some((weight, _))) = (&first_pose, touch) {
            first_pose = Some((name, at(weight)));
        }
    }

    let Some((name, q)) = first_pose else { return Ok(()) };
    let mut colliding = vec![false; model.mesh().faces().len()];
    for &(i, j) in query.discrete(&q)? {
        colliding[i as usize] = true;
        colliding[j as usize] = true;
    }
    let path = env::temp_dir().join("glb_face.ply");
    write_ply_pose(&path, model.mesh(), &model.positions(&q)?, &colliding)?;
    println!("{name}, touching triangles red: {}", path.display());
    Ok(())
}
