//! Measures the computation of modes of solids: `cargo bench -p sscc-bench --bench solids`.
//!
//! The bench runs itself once for each row, so that the peak memory is that of one model. It prints time and peak
//! memory from a surface to 30 nonlinear modes, at the default resolution and over degrees of freedom. It compares the
//! bunny's first ten frequencies in the default lattice with those in a lattice twice as fine (20 GB of memory;
//! `--quick` omits this part). Real models are taken from `SSCC_MODELS`, else from `../shared/models`.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use sscc_io::write_model;
use sscc_solid::PartialMaterial;
use sscc_tasks::{ModesKind, PeakMemory, SolidSource, elastic_model};

/// Any error ends the bench.
type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The argument by which the bench runs itself: before a mesh, a kind of modes, a rank and a resolution.
const CHILD: &str = "--child";

/// The resolution of the default lattice.
const DEFAULT: &str = "default";

/// Cost and frequencies of one model.
struct Run {
    degrees_of_freedom: u64,
    frequencies: Vec<f64>,
    seconds: f64,
    /// Peak memory (MB); None except on Linux.
    megabytes: Option<f64>,
}

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [child, mesh, kind, rank, resolution, ..] = &arguments[..]
        && child == CHILD
    {
        return make(mesh.as_ref(), kind, rank.parse()?, resolution);
    }
    let Some(folder) = sscc_testing::models("the benches of solids") else { return Ok(()) };
    let (bunny, dragon) = (folder.join("bunny_14964_closed.obj"), folder.join("dragon_77202_closed.ply"));
    println!("| surface | lattice | modes | degrees of freedom | s | MB |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for resolution in [DEFAULT, "21", "31", "50"] {
        report("bunny", resolution, "nonlinear 30", &run(&bunny, "nonlinear", 30, resolution)?);
    }
    report("dragon", DEFAULT, "nonlinear 30", &run(&dragon, "nonlinear", 30, DEFAULT)?);
    let coarse = run(&bunny, "linear", 10, DEFAULT)?;
    report("bunny", DEFAULT, "linear 10", &coarse);
    if arguments.iter().any(|argument| argument == "--quick") {
        return Ok(());
    }
    // The default lattice has about 44 cubes along the bunny.
    let fine = run(&bunny, "linear", 10, "88")?;
    report("bunny", "88", "linear 10", &fine);
    println!("\n| mode | Hz, default | Hz, twice as fine | higher by |\n| --- | --- | --- | --- |");
    for (k, (a, b)) in coarse.frequencies.iter().zip(&fine.frequencies).enumerate() {
        println!("| {} | {a:.2} | {b:.2} | {:.1}% |", k + 1, 100.0 * (a / b - 1.0));
    }
    Ok(())
}

fn report(surface: &str, lattice: &str, modes: &str, run: &Run) {
    let megabytes = run.megabytes.map_or("-".into(), |x| format!("{x:.0}"));
    let Run { degrees_of_freedom, seconds, .. } = run;
    println!("| {surface} | {lattice} | {modes} | {degrees_of_freedom} | {seconds:.1} | {megabytes} |");
}

/// Computes a model in a process of its own.
fn run(mesh: &Path, kind: &str, rank: usize, resolution: &str) -> Result<Run> {
    let mut command = Command::new(std::env::current_exe()?);
    command.arg(CHILD).arg(mesh).args([kind, &rank.to_string(), resolution]);
    let start = Instant::now();
    let output = command.output()?;
    let seconds = start.elapsed().as_secs_f64();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} at {resolution} failed: {error}", mesh.display());
    let text = String::from_utf8(output.stdout)?;
    let [degrees_of_freedom, bytes, frequencies] = text.lines().collect::<Vec<_>>()[..] else {
        return Err(format!("three lines were expected: {text}").into());
    };
    Ok(Run {
        degrees_of_freedom: degrees_of_freedom.parse()?,
        frequencies: frequencies.split(' ').map(str::parse).collect::<std::result::Result<_, _>>()?,
        seconds,
        megabytes: bytes.parse::<f64>().ok().map(|bytes| bytes / 1e6),
    })
}

/// Computes a model. Prints its degrees of freedom, the peak memory (bytes) and its frequencies, one line each.
fn make(mesh: &Path, kind: &str, rank: usize, resolution: &str) -> Result<()> {
    let peak = PeakMemory::start();
    let kind = if kind == "linear" { ModesKind::Linear } else { ModesKind::Nonlinear };
    let cells = if resolution == DEFAULT { None } else { Some(resolution.parse()?) };
    let source = SolidSource::read(mesh, cells, 1.0, &PartialMaterial::default(), &())?;
    let made = elastic_model(kind, Some(rank), source, &[], "bench", &())?;
    let folder = tempfile::tempdir()?;
    write_model(&folder.path().join("bench.model.safetensors"), &made.model, &made.info)?;
    let solid = made.solid.ok_or("a model of a solid")?;
    let frequencies: Vec<String> = solid.frequencies.iter().map(f64::to_string).collect();
    println!("{}", solid.degrees_of_freedom);
    println!("{}", peak.and_then(PeakMemory::bytes).map_or("-".into(), |bytes| bytes.to_string()));
    println!("{}", frequencies.join(" "));
    Ok(())
}
