//! Finds a weight at which each morph target makes a face touch itself, by 201 samples. `Query::sweep` finds the first one.
//!
//! `cargo run --release -p sscc-examples --example glb_face [FACE.glb [MESH]]`
#![allow(clippy::print_stdout)]

use std::env;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use sscc::{Certificates, CertifyOptions, Query};
use sscc_examples::{exit_code, mouth_glb};
use sscc_io::{LoadOptions, load_model_with, write_ply_pose};

/// Number of steps of the weight from 0 to 1.
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

    // A glTF file splits vertices along seams. The model stores this, and welds equal vertices: otherwise triangles
    // on the two sides of a seam would share no vertex, and always collide. Pairs that collide at rest (closed lips, eyes
    // in their sockets) are ignored.
    let options = CertifyOptions::default().ignore_rest(0);
    let certificates = Certificates::compute(&model, &options, &())?;
    println!("ignored because they collide at rest: {} pairs", certificates.rest_collisions());

    let mut query = Query::new(&model, &certificates)?;
    let mut first_pose = None;
    for (k, name) in loaded.mode_names.iter().enumerate() {
        let at = |weight: f64| {
            let mut q = vec![0.0; model.rank()];
            q[k] = weight;
            q
        };
        // The shape is proven free at every weight up to the safe scale, so the sweep starts there.
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
    println!("{name}, with the colliding triangles in red: {}", path.display());
    Ok(())
}
