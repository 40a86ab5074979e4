//! `cargo xtask wasm`: builds the npm package of `crates/sscc-wasm` in `target/npm/sscc`. With `--test` it builds one to test, and runs
//! its tests in Node and in a browser, which compare certificates and answers with the native ones, byte for byte.

mod checks;
mod package;
mod toolchain;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

use toolchain::Toolchain;

use crate::page;
use crate::program::{exit_code, root, usage};
use crate::tally::{SkipLog, Tally};

/// Runs the task, and returns its exit code.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(build()),
        [flag] if flag == "--test" => {
            let log = SkipLog::new();
            let tally = test(log.path());
            log.conclude(tally)
        }
        _ => {
            usage("wasm [--test]    (builds the package for npm; --test: tests it in Node and in a browser)")
        }
    }
}

fn build() -> Result<(), String> {
    let folder = root().join("target/npm/sscc");
    package::build(&Toolchain::find(false)?, &folder)?;
    let module = fs::metadata(folder.join("sscc_bg.wasm")).map_err(|error| error.to_string())?;
    println!("built: target/npm/sscc (module of {} bytes)", module.len());
    Ok(())
}

/// Builds a package and tests it.
fn test(log: &Path) -> Tally {
    println!("== WebAssembly");
    let found = page::node().and_then(|()| Toolchain::find(SkipLog::is_strict()));
    let toolchain = match found {
        Ok(toolchain) => toolchain,
        Err(reason) => return SkipLog::skip(log, "the package for npm", &reason),
    };
    let folder = root().join("target/npm-test/sscc");
    match package::build_to_test(&toolchain, &folder) {
        Ok(()) => checks::run(log, &folder),
        Err(line) => {
            println!("error: {line}");
            Tally::BROKEN
        }
    }
}
