//! `cargo xtask wasm`: builds the npm package of `crates/sscc-wasm` in `target/npm/sscc`. With `--test` it builds a package
//! with assertions, and runs its tests in Node and in a browser, which compare certificates and answers with the native ones,
//! byte for byte. `--release` tests the package that is published.

mod checks;
mod package;
mod toolchain;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use toolchain::Toolchain;

use crate::page;
use crate::program::{exit_code, root, usage};
use crate::tally::{SkipLog, Tally};

/// Runs the task, and returns its exit code.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(build()),
        [flag] if flag == "--test" => conclude(&root().join("target/npm-test/sscc"), package::build_to_test),
        [flag, profile] if flag == "--test" && profile == "--release" => {
            conclude(&published(), package::build)
        }
        _ => usage(
            "wasm [--test [--release]]    (builds the package for npm; --test: tests one with assertions in Node and in a \
             browser; --release: the one that is published)",
        ),
    }
}

/// Returns the folder of the package that is published.
fn published() -> PathBuf {
    root().join("target/npm/sscc")
}

fn build() -> Result<(), String> {
    let folder = published();
    package::build(&Toolchain::find(false)?, &folder)?;
    let module = fs::metadata(folder.join("sscc_bg.wasm")).map_err(|error| error.to_string())?;
    println!("built: target/npm/sscc (module of {} bytes)", module.len());
    Ok(())
}

/// Builds a package.
type Build = fn(&Toolchain, &Path) -> Result<(), String>;

/// Tests a package, and returns the exit code.
fn conclude(folder: &Path, build: Build) -> ExitCode {
    let log = SkipLog::new();
    let tally = test(log.path(), folder, build);
    log.conclude(tally)
}

fn test(log: &Path, folder: &Path, build: Build) -> Tally {
    println!("== WebAssembly");
    let found = page::node().and_then(|()| Toolchain::find(SkipLog::is_strict()));
    let toolchain = match found {
        Ok(toolchain) => toolchain,
        Err(reason) => return SkipLog::skip(log, "the package for npm", &reason),
    };
    match build(&toolchain, folder) {
        Ok(()) => checks::run(log, folder),
        Err(line) => {
            println!("error: {line}");
            Tally::BROKEN
        }
    }
}
