//! Prints digests of the certificates and of the answers of five small models that are created in code. The digests are the
//! same on every machine: `cargo xtask digests` compares them with `docs/records/digests.txt`.
//!
//! `cargo run --release -p sscc-examples --example digests [FOLDER]`. With a folder, the models, the q, and the bytes of certificates and
//! answers are also written there, for programs in other languages: `models.json` lists them.
#![allow(clippy::print_stdout)]

use std::env;
use std::error::Error;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use glam::DVec3;
use serde_json::json;
use sscc::{
    Certificates, CertifyOptions, ContactFilter, KineticQuery, Modes, Neighbours, Query, ReducedModel,
    TriMesh,
};
use sscc_examples::{exit_code, mouth_glb};
use sscc_io::ModelInfo;
use sscc_io::container::{certificates_to_bytes, model_to_bytes};
use sscc_modes::polynomial_modes;
use sscc_modes::shapes::spring_of;

/// Number of q at which each model is queried, in a motion from q to q.
const SAMPLES: usize = 24;

fn main() -> ExitCode {
    exit_code(run())
}

fn run() -> Result<(), Box<dyn Error>> {
    let out = env::args_os().nth(1).map(PathBuf::from);
    let folder = tempfile::tempdir()?;
    let mut listed = Vec::new();
    let mouth = sscc_io::load_model(&mouth_glb(folder.path())?, None)?.0;
    let (exclude, include) = (Neighbours::Exclude, Neighbours::IncludeOneVertex);
    let dense = ReducedModel::new(spring_of(60, 6), polynomial_modes(&spring_of(60, 6))?)?;
    for (name, model, neighbours, reach) in [
        // One mode for each wave along the axis.
        ("waves", waves(spring_of(100, 8), 6)?, exclude, 0.3),
        // All modes move all vertices; a dense metric would not differ from the metric by area.
        ("polynomials", dense, exclude, 0.1),
        // Morph targets of single precision, with seams that are welded.
        ("mouth", mouth, exclude, 3.0),
        // Few modes move each vertex, as in a skin.
        ("strips", strips(0.2)?, exclude, 3.0),
        // Strips that cross at rest have exceptions. Pairs with a common vertex count.
        ("crossing", strips(0.0)?, include, 0.5),
    ] {
        let filter = (neighbours != exclude).then(|| ContactFilter::new(neighbours));
        let options = CertifyOptions::default().filter(filter);
        let certificates = Certificates::compute(&model, &options, &())?;
        let bytes = certificates_to_bytes(&certificates)?;
        let motion = motion(model.rank(), reach);
        let (answers, colliding) = answers(&model, &certificates, &motion)?;
        println!(
            "{name}: {} triangles, {} modes, {colliding} of {SAMPLES} collide\n  certificates {}\n  answers      {}",
            model.mesh().faces().len(),
            model.rank(),
            blake3::hash(&bytes),
            blake3::hash(&answers)
        );
        if let Some(out) = &out {
            let weld = model.mesh().has_split_vertices();
            let model = model_to_bytes(&model, &ModelInfo::new("", "digests"))?;
            for (part, bytes) in [("model", &model), ("certificates", &bytes), ("answers", &answers)] {
                fs::write(out.join(format!("{name}.{part}")), bytes)?;
            }
            listed.push(
                json!({"name": name, "neighbours": neighbours.to_string(), "weld": weld, "motion": motion}),
            );
        }
    }
    if let Some(out) = &out {
        fs::write(out.join("models.json"), serde_json::to_string(&listed)?)?;
    }
    Ok(())
}

/// Returns the q of a motion.
fn motion(rank: usize, reach: f64) -> Vec<Vec<f64>> {
    let share = |sample: usize| sample as f64 / SAMPLES as f64;
    let weight = |k: usize, share: f64| reach * share * libm::sin((k * k + 1) as f64 + 2.0 * share);
    (0..SAMPLES).map(|sample| (0..rank).map(|k| weight(k, share(sample))).collect()).collect()
}

/// Returns the bytes of pairs and times of all kinds of queries, and the number of q that collide.
fn answers(
    model: &ReducedModel,
    certificates: &Certificates,
    motion: &[Vec<f64>],
) -> Result<(Vec<u8>, usize), Box<dyn Error>> {
    let mut query = Query::new(model, certificates)?;
    let mut kinetic = KineticQuery::new(model, certificates)?;
    let (mut bytes, mut colliding) = (Vec::new(), 0);
    let mut before = &vec![0.0; model.rank()];
    for q in motion {
        let pairs = query.discrete(q)?.to_vec();
        colliding += usize::from(!pairs.is_empty());
        assert_eq!(pairs, kinetic.discrete(q)?, "two methods differ");
        pairs.iter().for_each(|&(a, b)| bytes.extend([a.to_le_bytes(), b.to_le_bytes()].concat()));
        bytes.extend(query.safe_scale(q)?.to_le_bytes());
        for impact in query.continuous(before, q)? {
            bytes.extend(impact.pair.0.to_le_bytes());
            bytes.extend(impact.pair.1.to_le_bytes());
            bytes.extend(impact.time.to_le_bytes());
        }
        before = q;
    }
    Ok((bytes, colliding))
}

/// Returns a mesh with modes that are waves along z.
fn waves(mesh: TriMesh, rank: usize) -> Result<ReducedModel, sscc::Error> {
    let displacements = mesh.rest_positions().iter().flat_map(|p| {
        (0..rank).map(|k| {
            let axis = DVec3::AXES[k % 3];
            axis * libm::sin((k + 2) as f64 * p.z + k as f64)
        })
    });
    let modes = Modes::new(rank, displacements.collect())?;
    ReducedModel::new(mesh, modes)
}

/// Returns five strips above each other, each with a mode that bends it. At `height` 0 they cross each other.
fn strips(height: f64) -> Result<ReducedModel, sscc::Error> {
    const LENGTH: u32 = 24;
    const STRIPS: u32 = 5;
    let (mut positions, mut faces, mut displacements) = (Vec::new(), Vec::new(), Vec::new());
    for strip in 0..STRIPS {
        let first = positions.len() as u32;
        let turn = libm::sincos(0.6 * f64::from(strip));
        for i in 0..=LENGTH {
            for j in 0..2 {
                let (x, y) = (f64::from(i) / f64::from(LENGTH) - 0.45, 0.1 * f64::from(j) - 0.03);
                let tilt = 0.02 * y * f64::from(strip);
                let z = height * f64::from(strip) + tilt;
                positions.push(DVec3::new(turn.1 * x - turn.0 * y, turn.0 * x + turn.1 * y, z));
                displacements
                    .extend((0..STRIPS).map(|k| DVec3::Z * if k == strip { x * x - 0.1 } else { 0.0 }));
            }
        }
        for i in 0..LENGTH {
            let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + 2 * i + corner);
            faces.extend([[a, b, c], [b, d, c]]);
        }
    }
    ReducedModel::new(TriMesh::new(positions, faces)?, Modes::new(STRIPS as usize, displacements)?)
}
