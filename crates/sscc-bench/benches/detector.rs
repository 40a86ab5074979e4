//! Compares the detector for given positions with parry3d-f64, on one thread:
//! `cargo bench -p sscc-bench --bench detector [-- FILE...]` (default: bunny and dragon in `SSCC_MODELS`, else in
//! `../shared/models`, and the embedded spring).
//!
//! *One-shot* includes the build of the hierarchy. *Repeated* queries use random q of 20 polynomial modes: the detector gets
//! the positions, the traditional query moves the vertices itself. *Two meshes* is the mesh against a rotated copy. All
//! methods use the same exact test of two triangles and must list the same pairs. Times are medians of interleaved
//! repetitions in milliseconds.
#![allow(clippy::print_stdout)]

mod peer;

use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::{DMat3, DVec3};
use parry3d_f64::partitioning::BvhBuildStrategy;
use peer::Peer;
use sscc::parts::Scope;
use sscc::{Detector, Method, Modes, Pair, Query, ReducedModel, TriMesh};
use sscc_bench::Random;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Interleaved repetitions of each method.
const REPETITIONS: usize = 15;

fn main() -> Result<()> {
    let files: Vec<PathBuf> =
        std::env::args().skip(1).filter(|a| a != "--bench").map(PathBuf::from).collect();
    let folder =
        std::env::var_os("SSCC_MODELS").map_or_else(|| PathBuf::from("../shared/models"), PathBuf::from);
    let files = if files.is_empty() {
        ["bunny_14964_closed.obj", "bunny_69664_closed.ply", "dragon_77202_closed.ply"]
            .map(|name| folder.join(name))
            .to_vec()
    } else {
        files
    };
    println!(
        "| mesh | triangles | pairs | one-shot | parry | parry/ours | repeated | traditional | ours/traditional | two meshes | parry | parry/ours |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    row("spring", sscc_modes::shapes::spring())?;
    for file in files {
        if !file.is_file() {
            println!("{}: not found; set SSCC_MODELS to the folder of models", file.display());
            continue;
        }
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        row(&name, sscc_io::read_mesh(Path::new(&file))?)?;
    }
    Ok(())
}

fn row(name: &str, mesh: TriMesh) -> Result<()> {
    let rest = mesh.rest_positions().to_vec();
    let (shot, pairs) = {
        let ours = || Ok(Detector::new(&mesh).discrete(&rest)?.to_vec());
        let binned = || Ok(Peer::new(BvhBuildStrategy::Binned, &mesh, &rest).with_itself());
        let ploc = || Ok(Peer::new(BvhBuildStrategy::Ploc, &mesh, &rest).with_itself());
        interleaved(&mut [&mut { ours }, &mut { binned }, &mut { ploc }])?
    };
    let model = ReducedModel::new(mesh.clone(), smooth_modes(&mesh)?)?;
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional)?;
    let mut detector = Detector::new(&mesh);
    let random = &mut Random(7);
    let size = rest.iter().fold(0.0_f64, |size, x| size.max(x.abs().max_element()));
    let mut ratios = Vec::new();
    let mut times = (Vec::new(), Vec::new());
    for _ in 0..REPETITIONS {
        let q: Vec<f64> = (0..model.rank()).map(|_| 0.02 * size * random.normal()).collect();
        let x = model.positions(&q)?;
        let start = Instant::now();
        let ours = detector.discrete(&x)?.to_vec();
        let mine = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let theirs = query.discrete(&q)?.to_vec();
        let traditional = start.elapsed().as_secs_f64();
        assert!(ours == theirs, "{name}: the answers differ");
        ratios.push(mine / traditional);
        times.0.push(mine * 1e3);
        times.1.push(traditional * 1e3);
    }
    // A copy that passes through the mesh.
    let turned: Vec<DVec3> =
        rest.iter().map(|x| DMat3::from_rotation_x(0.7) * *x + DVec3::X * 0.05 * size).collect();
    let mut other = Detector::new(&mesh);
    let mut peers = [
        Peer::new(BvhBuildStrategy::Binned, &mesh, &rest),
        Peer::new(BvhBuildStrategy::Binned, &mesh, &turned),
    ];
    let (two, crossing) = {
        let ours = || Ok(detector.against(&rest, &mut other, &turned)?.to_vec());
        let parry = || {
            peers[0].refit(&rest);
            peers[1].refit(&turned);
            Ok(peers[0].with(&peers[1]))
        };
        interleaved(&mut [&mut { ours }, &mut { parry }])?
    };
    let parry = shot[1].min(shot[2]);
    println!(
        "| {name} | {} | {} | {:.2} | {parry:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} ({}) | {:.2} | {:.2} |",
        mesh.faces().len(),
        pairs.len(),
        shot[0],
        parry / shot[0],
        median(&mut times.0),
        median(&mut times.1),
        median(&mut ratios),
        two[0],
        crossing.len(),
        two[1],
        two[1] / two[0],
    );
    Ok(())
}

/// Returns twenty smooth modes: waves along random directions.
fn smooth_modes(mesh: &TriMesh) -> Result<Modes> {
    let random = &mut Random(3);
    let size = mesh.rest_positions().iter().fold(0.0_f64, |size, x| size.max(x.abs().max_element()));
    let waves: Vec<[DVec3; 2]> = (0..20)
        .map(|_| [(); 2].map(|()| DVec3::new(random.normal(), random.normal(), random.normal())))
        .collect();
    let entries = mesh.rest_positions().iter().flat_map(|x| {
        waves.iter().map(move |[dir, wave]| *dir * (2.0 * x.dot(*wave) / size).sin()).collect::<Vec<_>>()
    });
    Ok(Modes::new(waves.len(), entries.collect())?)
}

type Job<'j> = dyn FnMut() -> Result<Vec<Pair>> + 'j;

/// Returns the medians of the times of interleaved repetitions (ms), and the common answer.
fn interleaved(jobs: &mut [&mut Job<'_>]) -> Result<(Vec<f64>, Vec<Pair>)> {
    let mut times = vec![Vec::new(); jobs.len()];
    let mut answer: Option<Vec<Pair>> = None;
    for _ in 0..REPETITIONS {
        for (job, times) in jobs.iter_mut().zip(&mut times) {
            let start = Instant::now();
            let pairs = black_box(job()?);
            times.push(start.elapsed().as_secs_f64() * 1e3);
            assert!(answer.get_or_insert_with(|| pairs.clone()) == &pairs, "the answers differ");
        }
    }
    Ok((times.iter_mut().map(|times| median(times)).collect(), answer.unwrap_or_default()))
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
