//! `cargo xtask site`: builds the site of the documents in `target/site`, and checks its links, its figures and its size.
//! With `--with-rustdoc` the site includes the documentation of the crates.
//!
//! The work is done by `docs/site/build.py`, in an environment with the packages of `docs/site/requirements.txt`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use crate::environment::{Failure, environment, succeed};
use crate::program::{cargo, exit_code, root, usage};
use crate::tally::{SkipLog, Tally};

/// Builds and checks the site.
pub fn run(arguments: &[String]) -> ExitCode {
    let with_rustdoc = match arguments {
        [] => false,
        [flag] if flag == "--with-rustdoc" => true,
        _ => return usage("site [--with-rustdoc]    (builds the site of the documents in target/site)"),
    };
    let built = build_command().and_then(|()| build(with_rustdoc));
    exit_code(
        built
            .map(|site| println!("written: {}", site.join("index.html").display()))
            .map_err(Failure::into_line),
    )
}

/// Builds and checks the site as one test, which is skipped without Python or its packages. Expects that the command is built.
pub fn test(log: &Path) -> Tally {
    println!("== Site");
    match build(false) {
        Ok(_) => Tally { passed: 1, failed: 0 },
        Err(Failure::Missing(why)) => SkipLog::skip(log, "the site of the documents", &why),
        Err(Failure::Broken(why)) => {
            println!("error: {why}");
            Tally::BROKEN
        }
    }
}

fn build_command() -> Result<(), Failure> {
    let mut build = cargo();
    build.args(["build", "--package", "sscc-cli", "--bin", "sscc"]).current_dir(root());
    succeed(&mut build, "the command cannot be built")
}

/// Returns the folder of the site.
fn build(with_rustdoc: bool) -> Result<PathBuf, Failure> {
    let (tools, site) = (root().join("docs/site"), root().join("target/site"));
    let python = environment(&root().join("target/site-tools"), &tools.join("requirements.txt"))?;
    let xtask = env::current_exe().map_err(|error| Failure::Broken(format!("this program: {error}")))?;
    let command = xtask.with_file_name(format!("sscc{}", env::consts::EXE_SUFFIX));
    let mut build = Command::new(&python);
    build.arg(tools.join("build.py")).arg("--command").arg(command).arg("--out").arg(&site);
    if with_rustdoc {
        let folder = root().join("target/site-rustdoc");
        let _ = fs::remove_dir_all(&folder);
        let mut doc = cargo();
        doc.args(["doc", "--workspace", "--no-deps", "--target-dir"]).arg(&folder).current_dir(root());
        succeed(&mut doc, "the documentation of the crates cannot be built")?;
        build.arg("--rustdoc").arg(folder.join("doc"));
    }
    succeed(&mut build, "the site cannot be built")?;
    Ok(site)
}
