//! What modes of solids cost: `cargo bench -p sscc-cli --bench solids`.
//!
//! Runs the command itself. Time and peak memory from a surface to 30 nonlinear modes, at the default resolution and
//! over degrees of freedom, and the bunny's first ten frequencies in the default lattice against those in one twice as
//! fine (that needs 20 GB; with `--quick` it is left out). Real models are taken from `SSCC_MODELS`, else from
//! `../shared/models`.
#![allow(clippy::print_stdout)]

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use serde_json::Value;

/// A run of `sscc modes`.
struct Run {
    freedom: u64,
    frequencies: Vec<f64>,
    seconds: f64,
    /// As the kernel tells (`VmHWM`); none elsewhere than on Linux.
    megabytes: Option<f64>,
}

fn main() -> Result<()> {
    let Some(folder) = sscc_testdata::models("the benches of solids") else { return Ok(()) };
    let (bunny, dragon) = (folder.join("bunny_14964_closed.obj"), folder.join("dragon_77202_closed.ply"));
    println!("| surface | lattice | modes | degrees of freedom | s | MB |");
    println!("| --- | --- | --- | --- | --- | --- |");
    let mut freedom = vec!["default"];
    freedom.extend(["21", "31", "50"]);
    for resolution in freedom {
        report("bunny", resolution, "nonlinear 30", &run(&bunny, "nonlinear", 30, resolution)?);
    }
    report("dragon", "default", "nonlinear 30", &run(&dragon, "nonlinear", 30, "default")?);
    let coarse = run(&bunny, "linear", 10, "default")?;
    report("bunny", "default", "linear 10", &coarse);
    if std::env::args().any(|arg| arg == "--quick") {
        return Ok(());
    }
    // The default lattice has 44 cubes along the bunny, nearly.
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
    println!("| {surface} | {lattice} | {modes} | {} | {:.1} | {megabytes} |", run.freedom, run.seconds);
}

fn run(mesh: &Path, kind: &str, rank: usize, resolution: &str) -> Result<Run> {
    let output = std::env::temp_dir().join(format!("sscc-bench-{}.model.safetensors", std::process::id()));
    let mut command = Command::new(env!("CARGO_BIN_EXE_sscc"));
    command.args(["modes", "--json", "--kind", kind, "--rank", &rank.to_string()]).arg(mesh);
    command.arg("-o").arg(&output);
    if resolution != "default" {
        command.args(["--resolution", resolution]);
    }
    let start = Instant::now();
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
    let status = format!("/proc/{}/status", child.id());
    let (mut megabytes, mut ended) = (None, None);
    while ended.is_none() {
        std::thread::sleep(Duration::from_millis(20));
        let peak = std::fs::read_to_string(&status).ok().and_then(|text| peak_megabytes(&text));
        megabytes = peak.or(megabytes);
        ended = child.try_wait()?;
    }
    let seconds = start.elapsed().as_secs_f64();
    let told = child.wait_with_output()?;
    ensure!(told.status.success(), "{} at {resolution} failed", mesh.display());
    std::fs::remove_file(&output)?;
    let json: Value = serde_json::from_slice(&told.stdout)?;
    let frequencies = json["frequencies_hz"].as_array().context("frequencies")?;
    Ok(Run {
        freedom: json["degrees_of_freedom"].as_u64().context("degrees of freedom")?,
        frequencies: frequencies.iter().filter_map(Value::as_f64).collect(),
        seconds,
        megabytes,
    })
}

fn peak_megabytes(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? / 1e3)
}
