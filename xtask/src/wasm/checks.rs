//! Tests of the package in Node and in a browser.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::digests;
use crate::page;
use crate::program::{cargo, root, run_and_forward, succeed};
use crate::tally::{SkipLog, Tally};

/// Runs the tests of the package in `folder`.
pub fn run(log: &Path, folder: &Path) -> Tally {
    let prepared = native_bytes().and_then(|digests| Ok((digests, command()?)));
    let (digests, command) = match prepared {
        Ok(prepared) => prepared,
        Err(line) => {
            println!("error: {line}");
            return Tally::BROKEN;
        }
    };
    let test = |file: &str| {
        let mut node = Command::new("node");
        node.args(["--test", "--test-reporter=tap", file])
            .current_dir(root().join("crates/sscc-wasm/tests"))
            .env("SSCC_PACKAGE", folder)
            .env("SSCC_DIGESTS", &digests)
            .env("SSCC_COMMAND", &command)
            .stdin(Stdio::null());
        let mut text = String::new();
        match run_and_forward(&mut node, |line| text.extend([line, "\n"])) {
            Ok(success) => page::tally(success, &text),
            Err(_) => Tally::BROKEN,
        }
    };
    let in_node = test("node.test.mjs") + test("docs.test.mjs");
    in_node
        + match page::browser(SkipLog::is_strict()) {
            Ok(()) => test("types.test.mjs") + test("chromium.test.mjs"),
            Err(reason) => {
                SkipLog::skip(log, "the types of the package for npm, and the package in a browser", &reason)
            }
        }
}

/// Writes the native certificates and answers of five models, and checks their digests by the record. Returns their folder.
fn native_bytes() -> Result<PathBuf, String> {
    let folder = root().join("target/npm-test/digests");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    digests::write_bytes(&folder)?;
    Ok(folder)
}

/// Builds the command. Returns its path.
fn command() -> Result<PathBuf, String> {
    let mut build = cargo();
    build.args(["build", "--package", "sscc-cli"]).current_dir(root());
    succeed(&mut build, "the command cannot be built")?;
    // The command is in the folder of this program.
    let program = env::current_exe().map_err(|error| error.to_string())?;
    Ok(program.with_file_name(format!("sscc{}", env::consts::EXE_SUFFIX)))
}
