//! `cargo xtask package`: packs the crates that are published, and checks the packages.
//!
//! Each package has a description, a licence with its text, a readme, keywords, categories and the oldest version of Rust,
//! and is at most [`MAX_BYTES`] large. With `--verify` cargo also compiles each crate from only its package, which takes
//! minutes. Without a `repository` in the workspace's `Cargo.toml` cargo warns: the project has no public address yet.
//!
//! The packages are in `target/package`.

use std::fs;
use std::process::ExitCode;

use crate::packages::{self, Package};
use crate::program::{cargo, exit_code, root, succeed, usage};

/// The maximum size of a package. One package contains the page, a single file of 660 kB.
const MAX_BYTES: u64 = 1_000_000;

/// Packs and checks the crates.
pub fn run(arguments: &[String]) -> ExitCode {
    let mut verify = false;
    for argument in arguments {
        match argument.as_str() {
            "--verify" => verify = true,
            _ => return usage("package [--verify]    (packs the crates; --verify: compiles the packages)"),
        }
    }
    exit_code(pack_and_check(verify))
}

fn pack_and_check(verify: bool) -> Result<(), String> {
    let (published, others): (Vec<_>, Vec<_>) =
        packages::read()?.into_iter().partition(|package| package.is_published);
    published.iter().try_for_each(check_manifest)?;
    let pack = |offline: bool| {
        let mut pack = cargo();
        // The package includes changes that are not committed, so that a developer can test them.
        pack.args(["package", "--workspace", "--quiet", "--allow-dirty"]).current_dir(root());
        pack.arg("--target-dir").arg(root().join("target"));
        others.iter().for_each(|other| _ = pack.args(["--exclude", &other.name]));
        pack.args((!verify).then_some("--no-verify")).args(offline.then_some("--offline"));
        succeed(&mut pack, "the crates cannot be packed")
    };
    // The first attempt is offline, because the registry answers slowly and is usually not needed.
    pack(true).or_else(|_| pack(false))?;
    published.iter().try_for_each(check_size)
}

fn check_manifest(package: &Package) -> Result<(), String> {
    let name = &package.name;
    if let Some(key) = package.missing.first() {
        return Err(format!("{name}: Cargo.toml has no {key}"));
    }
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        let texts = [package.folder.join(licence), root().join(licence)].map(|path| fs::read(path).ok());
        if texts[0].is_none() || texts[0] != texts[1] {
            return Err(format!(
                "{name}: {licence} differs from the file of the workspace; replace it by a link to that file"
            ));
        }
    }
    Ok(())
}

fn check_size(package: &Package) -> Result<(), String> {
    let file = format!("{}-{}.crate", package.name, package.version);
    let path = root().join("target/package").join(&file);
    let bytes = fs::metadata(&path).map_err(|error| format!("{}: {error}", path.display()))?.len();
    println!("{:>7} kB  {file}", bytes / 1000);
    if bytes > MAX_BYTES {
        return Err(format!(
            "{file}: {bytes} bytes, at most {MAX_BYTES} were expected; see `include` in Cargo.toml"
        ));
    }
    Ok(())
}
