//! `cargo xtask wheel`: builds the source distribution and the wheel of the Python package, and checks them.
//!
//! The tracked files are copied, the source distribution is built from the copy alone, and the wheel from the source
//! distribution, both in environments of their own. On Linux zig links the wheel against glibc 2.17 (manylinux2014). Then
//! twine checks the metadata, abi3audit that the module uses only Python's stable interface, and auditwheel the version of
//! glibc. At last the wheel is installed beside NumPy in an environment without Rust, and runs the examples.
//!
//! The results are in `target/wheel/dist`.

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use crate::environment::{Failure, empty_environment, environment, files, pip, programs};
use crate::program::{exit_code, output, root, succeed, usage};

/// Examples that need only NumPy.
const EXAMPLES: [&str; 4] = ["deforming", "many", "pca_shapes", "performance"];

/// Options of maturin for Linux. The wheel works with glibc 2.17 (2012) or later, which Rust itself needs, too.
const LINUX: &str = "--zig --compatibility manylinux2014";

/// Builds and checks the distributions.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(build_and_check()),
        _ => usage("wheel    (builds and checks the source distribution and the wheel)"),
    }
}

fn build_and_check() -> Result<(), String> {
    let folder = root().join("target/wheel");
    let tools = folder.join("tools");
    let python =
        environment(&tools, &root().join("python/wheel/requirements.txt")).map_err(Failure::into_line)?;
    let (copy, dist) = (folder.join("copy"), folder.join("dist"));
    copy_tracked_files(&copy)?;
    remove(&dist)?;

    let mut build = Command::new(&python);
    build.args(["-m", "build", "--outdir"]).arg(&dist).arg(copy.join("python"));
    build.env("CARGO_TARGET_DIR", folder.join("build"));
    if cfg!(target_os = "linux") {
        let zig = "import os, ziglang; print(os.path.join(os.path.dirname(ziglang.__file__), 'zig'))";
        let zig = output(Command::new(&python).args(["-c", zig]), "zig is not installed")?;
        build.env("CARGO_ZIGBUILD_ZIG_PATH", zig.trim()).env("MATURIN_PEP517_ARGS", LINUX);
    }
    succeed(&mut build, "the wheel cannot be built")?;

    let all = files(&dist);
    let wheel = wheel_of(&all)?;
    succeed(
        Command::new(&python).args(["-m", "twine", "check", "--strict"]).args(&all),
        "twine refuses the metadata",
    )?;
    let abi3 = programs(&tools).join("abi3audit");
    succeed(Command::new(abi3).args(["--strict", "--summary"]).arg(&wheel), "the wheel is not abi3")?;
    if cfg!(target_os = "linux") {
        succeed(
            Command::new(&python).args(["-m", "auditwheel", "show"]).arg(&wheel),
            "auditwheel refuses the wheel",
        )?;
    }
    install_and_try(&folder.join("empty"), &wheel)?;
    for file in all {
        let bytes = fs::metadata(&file).map_or(0, |found| found.len());
        println!("{}: {} kB", file.display(), bytes / 1000);
    }
    Ok(())
}

/// Copies the files that git tracks, in their current state, to an empty folder.
fn copy_tracked_files(to: &Path) -> Result<(), String> {
    remove(to)?;
    let list =
        output(Command::new("git").args(["ls-files", "-z"]).current_dir(root()), "git lists no files")?;
    for name in list.split('\0').filter(|name| !name.is_empty()) {
        let (from, to) = (root().join(name), to.join(name));
        let at = |error| format!("{}: {error}", from.display());
        fs::create_dir_all(to.parent().unwrap_or(&to)).map_err(at)?;
        // A deleted file that git still lists is not copied.
        if from.exists() {
            fs::copy(&from, &to).map_err(at)?;
        }
    }
    Ok(())
}

fn remove(folder: &Path) -> Result<(), String> {
    match fs::remove_dir_all(folder) {
        Err(error) if folder.exists() => Err(format!("{}: {error}", folder.display())),
        _ => Ok(()),
    }
}

/// Returns the only wheel among files.
fn wheel_of(files: &[PathBuf]) -> Result<PathBuf, String> {
    let mut wheels = files.iter().filter(|path| path.extension().is_some_and(|end| end == "whl"));
    match (wheels.next(), wheels.next()) {
        (Some(wheel), None) => Ok(wheel.clone()),
        _ => Err("target/wheel/dist: expected one wheel".to_owned()),
    }
}

/// Installs the wheel beside NumPy, and runs the examples with a search path without Rust.
fn install_and_try(folder: &Path, wheel: &Path) -> Result<(), String> {
    let python = empty_environment(folder).map_err(Failure::into_line)?;
    let path = env::join_paths([programs(folder)]).unwrap_or_else(|_| OsString::new());
    succeed(
        pip(&python).args(["install", "--quiet", "--only-binary", ":all:"]).arg(wheel).env("PATH", &path),
        "the wheel cannot be installed",
    )?;
    for example in EXAMPLES {
        println!("== {example}.py");
        let file = root().join("python/examples").join(format!("{example}.py"));
        let mut run = Command::new(&python);
        // Python searches only the folder of the examples for modules of this project.
        run.arg(file).current_dir(folder).env("PATH", &path).env_remove("PYTHONPATH");
        succeed(&mut run, &format!("the example {example} fails with the wheel"))?;
    }
    Ok(())
}
