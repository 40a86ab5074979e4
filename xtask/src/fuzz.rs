//! `cargo xtask fuzz`: runs readers with inputs that libFuzzer generates (`fuzz/`), each target for some seconds.
//!
//! The targets are compiled with the coverage of libFuzzer and the address sanitizer, by the stable compiler, which takes
//! these options with `RUSTC_BOOTSTRAP=1`; cargo-fuzz is not needed. Small valid files are the first inputs. The fuzzer keeps
//! further inputs in `target/fuzz`, and also writes each input that breaks a bound there. `--write` adds the run to the record
//! that documents show.

use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::Instant;

use crate::fuzz_record::{self, Ran};
use crate::program::{cargo, exit_code, root, succeed, usage};

const USAGE: &str = "fuzz [--seconds N] [--write] [targets]    (N at least 1)";

/// Options of the compiler: edge coverage and compared values for the fuzzer, and the address sanitizer.
const FLAGS: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing -Zsanitizer=address -Ccodegen-units=1";

/// The triple without which the flags would also apply to build scripts.
const TARGET: &str = "x86_64-unknown-linux-gnu";

/// The target that needs simulations, which take most of the time of the build.
const SCENE: &str = "scene";

/// Limits of memory of a target (MB), and of seconds for an input. They are higher than the bounds that targets assert.
const LIMITS: [&str; 3] = ["-rss_limit_mb=2048", "-malloc_limit_mb=512", "-timeout=20"];

/// Compiles the targets and runs all of them, or those named.
pub fn run(arguments: &[String]) -> ExitCode {
    let (mut seconds, mut writes) = (10_u32, false);
    let mut names = Vec::new();
    let mut arguments = arguments.iter();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--seconds" => match arguments.next().and_then(|text| text.parse().ok()) {
                Some(count) if count > 0 => seconds = count,
                _ => return usage(USAGE),
            },
            "--write" => writes = true,
            name if name.starts_with('-') => return usage(USAGE),
            name => names.push(name.to_owned()),
        }
    }
    exit_code(fuzz(seconds, writes, &names))
}

fn fuzz(seconds: u32, writes: bool, names: &[String]) -> Result<(), String> {
    let all = targets()?;
    if let Some(name) = names.iter().find(|name| !all.contains(name)) {
        return Err(format!("no target has the name '{name}'; the targets are: {}", all.join(", ")));
    }
    let chosen = || all.iter().filter(|name| names.is_empty() || names.contains(name));
    let programs = build(chosen().any(|name| name == SCENE))?;
    for name in chosen() {
        let folder = root().join("target/fuzz").join(name);
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        println!("== {name}, {seconds} s");
        let mut program = Command::new(programs.join(name));
        program.args(LIMITS).args(["-max_len=16384", "-print_final_stats=1", "-verbosity=0"]);
        program.arg(format!("-max_total_time={seconds}"));
        program.arg(format!("-artifact_prefix={}/failed-", folder.display()));
        program.arg(&folder).arg(root().join("fuzz/seeds").join(name)).current_dir(root());
        let (ran, is_good) = watch(&mut program).map_err(|error| format!("{name}: {error}"))?;
        if writes {
            fuzz_record::add(name, ran, !is_good)?;
        }
        if !is_good {
            return Err(format!("{name}: an input breaks a bound; it is in {}", folder.display()));
        }
    }
    Ok(())
}

/// Runs a target, whose messages it forwards. Returns what it ran, and whether no input failed.
fn watch(program: &mut Command) -> io::Result<(Ran, bool)> {
    let start = Instant::now();
    let mut child = program.stderr(Stdio::piped()).spawn()?;
    let mut inputs = 0;
    if let Some(messages) = child.stderr.take() {
        for line in BufReader::new(messages).split(b'\n') {
            let line = String::from_utf8_lossy(&line?).into_owned();
            inputs = fuzz_record::inputs_of(&line).unwrap_or(inputs);
            writeln!(io::stderr(), "{line}")?;
        }
    }
    let is_good = child.wait()?.success();
    Ok((Ran { inputs, seconds: start.elapsed().as_secs() }, is_good))
}

/// Returns the names of all targets.
fn targets() -> Result<Vec<String>, String> {
    let folder = root().join("fuzz/fuzz_targets");
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let stem = |path: PathBuf| path.file_stem().map(|name| name.to_string_lossy().into_owned());
    let mut names: Vec<String> = entries.flatten().filter_map(|entry| stem(entry.path())).collect();
    names.sort();
    Ok(names)
}

/// Compiles the targets, with or without [`SCENE`]. Returns the folder of the programs.
fn build(with_scene: bool) -> Result<PathBuf, String> {
    let folder = root().join("target/fuzz-build");
    let mut build = cargo();
    build
        .args(["build", "--release", "--locked", "--quiet", "--target", TARGET, "--target-dir"])
        .arg(&folder);
    build.args(with_scene.then_some("--features=scenes"));
    build.env("RUSTFLAGS", FLAGS).env("RUSTC_BOOTSTRAP", "1");
    succeed(
        build.current_dir(root().join("fuzz")),
        "the targets cannot be built (x86-64 Linux with a C++ compiler is needed)",
    )?;
    Ok(folder.join(Path::new(TARGET).join("release")))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::targets;
    use crate::program::root;

    #[test]
    fn every_target_is_in_the_manifest_and_has_first_inputs() {
        let manifest = fs::read_to_string(root().join("fuzz/Cargo.toml")).unwrap();
        let names = targets().unwrap();
        assert!(names.len() >= 12);
        for name in &names {
            assert!(manifest.contains(&format!("path = \"fuzz_targets/{name}.rs\"")), "{name}");
            let seeds = fs::read_dir(root().join("fuzz/seeds").join(name)).unwrap();
            assert!(seeds.count() > 0, "{name}");
        }
        assert_eq!(manifest.matches("[[bin]]").count(), names.len());
    }
}
