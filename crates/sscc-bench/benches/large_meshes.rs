//! Time and memory of the detector for large meshes, on one thread: `cargo bench -p sscc-bench --bench large_meshes`.
//!
//! *soup*: random triangles, none of which share vertices, at two sizes. *sheet*: a rolled sheet of connected triangles.
//! *Build* is the time to create the detector, *first* that of its first query, *repeated* the median of further queries.
//! *Memory* is the largest resident set of the process so far, on Linux; meshes come in ascending size.
#![allow(clippy::print_stdout)]

use std::time::Instant;

use glam::DVec3;
use sscc::{Detector, TriMesh};
use sscc_bench::Random;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Number of repeated queries.
const REPETITIONS: usize = 5;

fn main() -> Result<()> {
    println!(
        "| mesh | triangles | pairs | build (ms) | first (ms) | repeated (ms) | mesh (MiB) | memory (MiB) |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    row("sheet", || sheet(707))?;
    row("soup, edges of 0.001", || soup(1_000_000, 0.001))?;
    row("soup, edges of 0.01", || soup(1_000_000, 0.01))?;
    row("sheet", || sheet(1581))
}

fn row(name: &str, mesh: impl FnOnce() -> Result<TriMesh>) -> Result<()> {
    let mesh = mesh()?;
    let milliseconds = |start: Instant| start.elapsed().as_secs_f64() * 1e3;
    let start = Instant::now();
    let mut detector = Detector::new(&mesh);
    let build = milliseconds(start);
    let start = Instant::now();
    let pairs = detector.discrete(mesh.rest_positions())?.len();
    let first = milliseconds(start);
    let mut times = Vec::new();
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        assert_eq!(detector.discrete(mesh.rest_positions())?.len(), pairs);
        times.push(milliseconds(start));
    }
    times.sort_by(f64::total_cmp);
    let (triangles, repeated) = (mesh.faces().len(), times[times.len() / 2]);
    let own = (mesh.rest_positions().len() * 24 + triangles * 12) >> 20;
    let memory = peak_memory().map_or("unknown".to_owned(), |mebibytes| mebibytes.to_string());
    println!(
        "| {name} | {triangles} | {pairs} | {build:.0} | {first:.0} | {repeated:.0} | {own} | {memory} |"
    );
    Ok(())
}

/// Returns random triangles in the unit cube.
fn soup(triangles: u32, edge: f64) -> Result<TriMesh> {
    let random = &mut Random(11);
    let mut positions = Vec::new();
    for _ in 0..triangles {
        let place = DVec3::from_array([(); 3].map(|()| random.uniform()));
        let corner = |random: &mut Random| DVec3::from_array([(); 3].map(|()| random.normal()));
        positions.extend([(); 3].map(|()| place + corner(random) * edge));
    }
    Ok(TriMesh::new(positions, (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())?)
}

/// Returns a square sheet of `2 n^2` triangles, rolled up without touching itself.
fn sheet(n: u32) -> Result<TriMesh> {
    let position = |i: u32| {
        let [s, t] = [i % (n + 1), i / (n + 1)].map(|x| f64::from(x) / f64::from(n));
        let (sin, cos) = (40.0 * s).sin_cos();
        DVec3::new((1.0 + s) * cos, (1.0 + s) * sin, t)
    };
    let face = |i: u32| {
        let a = i / n * (n + 1) + i % n;
        [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    };
    Ok(TriMesh::new((0..(n + 1) * (n + 1)).map(position).collect(), (0..n * n).flat_map(face).collect())?)
}

/// Returns the largest resident set of this process (MiB), on Linux.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kibibytes| kibibytes >> 10)
}
