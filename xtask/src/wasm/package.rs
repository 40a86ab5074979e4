//! The npm package: the module, its scripts and its types.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::toolchain::{TARGET, Toolchain, cargo_home, renamed};
use crate::program::{cargo, root, succeed};

/// The file of the module.
const MODULE: &str = "sscc_bg.wasm";

/// The files of the package in `crates/sscc-wasm/npm`.
const FILES: [&str; 4] = ["package.json", "node.js", "queries.js", "README.md"];

/// The licences, which are in the root of the project.
const LICENCES: [&str; 2] = ["LICENSE-APACHE", "LICENSE-MIT"];

/// Builds the package that is published in `folder`. It is small and fast, and contains no paths of this machine.
pub fn build(toolchain: &Toolchain, folder: &Path) -> Result<(), String> {
    let flags = [renamed(&root(), "sscc"), renamed(&cargo_home(), "cargo")];
    let module = compile(toolchain, "wasm", &flags)?;
    assemble(&module, folder)?;
    let bytes = fs::read(folder.join(MODULE)).map_err(|error| format!("{MODULE}: {error}"))?;
    let home = env::var_os("HOME").map(PathBuf::from);
    match [Some(root()), Some(cargo_home()), home].into_iter().flatten().find(|path| has_path(&bytes, path)) {
        Some(path) => Err(format!("{MODULE} contains a path of this machine, below {}", path.display())),
        None => Ok(()),
    }
}

/// Whether bytes have a path below a folder.
fn has_path(bytes: &[u8], folder: &Path) -> bool {
    let text = format!("{}/", folder.display());
    text.len() > 1 && bytes.windows(text.len()).any(|part| part == text.as_bytes())
}

/// Builds a package with assertions for tests in `folder`, which takes less time.
pub fn build_to_test(toolchain: &Toolchain, folder: &Path) -> Result<(), String> {
    assemble(&compile(toolchain, "dev", &[])?, folder)
}

/// Compiles the module. Returns its path.
fn compile(toolchain: &Toolchain, profile: &str, flags: &[String]) -> Result<PathBuf, String> {
    // The folder belongs to this checkout only: with a shared one, cargo would use newer results of another checkout.
    let target = root().join("target/wasm");
    let mut build = toolchain.cargo(flags)?;
    build
        .args(["build", "--package", "sscc-wasm", "--lib", "--target", TARGET, "--profile", profile])
        .arg("--target-dir")
        .arg(&target)
        .env("CARGO_INCREMENTAL", "0")
        .current_dir(root());
    succeed(&mut build, "the module cannot be compiled")?;
    let folder = if profile == "dev" { "debug" } else { profile };
    Ok(target.join(TARGET).join(folder).join("sscc_wasm.wasm"))
}

/// Writes the package of a module.
fn assemble(module: &Path, folder: &Path) -> Result<(), String> {
    let io = |error: std::io::Error| format!("{}: {error}", folder.display());
    let _ = fs::remove_dir_all(folder);
    fs::create_dir_all(folder).map_err(io)?;
    bindgen(module, folder)?;
    // The script for pages without modules runs the same module.
    let same = folder.join("script").join(MODULE);
    if fs::read(&same).map_err(io)? != fs::read(folder.join(MODULE)).map_err(io)? {
        return Err("the modules of both kinds of scripts differ".to_owned());
    }
    fs::remove_file(same).map_err(io)?;
    let own = root().join("crates/sscc-wasm/npm");
    for (from, files) in [(own, &FILES[..]), (root(), &LICENCES[..])] {
        for file in files {
            fs::copy(from.join(file), folder.join(file)).map_err(io)?;
        }
    }
    Ok(())
}

/// Writes the scripts and types of a module with the program in `xtask/bindgen`.
fn bindgen(module: &Path, folder: &Path) -> Result<(), String> {
    let target = root().join("target/bindgen");
    let mut build = cargo();
    build
        .args(["build", "--quiet", "--locked", "--target-dir"])
        .arg(&target)
        .current_dir(root().join("xtask/bindgen"));
    succeed(&mut build, "xtask/bindgen cannot be compiled")?;
    let program = target.join("debug").join(format!("bindgen{}", env::consts::EXE_SUFFIX));
    succeed(Command::new(program).arg(module).arg(folder), "the scripts of the module cannot be written")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the version of wasm-bindgen in a lock file.
    fn locked(lock: &str) -> String {
        let text = fs::read_to_string(root().join(lock)).unwrap();
        let lock: toml::Table = text.parse().unwrap();
        let packages = lock["package"].as_array().unwrap();
        let version = |name: &str| packages.iter().find(|p| p["name"].as_str() == Some(name));
        let found = version("wasm-bindgen").or(version("wasm-bindgen-cli-support")).unwrap();
        found["version"].as_str().unwrap().to_owned()
    }

    #[test]
    fn paths_below_a_folder_are_found() {
        let bytes = b"\0asm\x01/home/me/.cargo/registry/src\0";
        assert!(has_path(bytes, Path::new("/home/me")) && has_path(bytes, Path::new("/home/me/.cargo")));
        assert!(!has_path(bytes, Path::new("/home/m")) && !has_path(bytes, Path::new("")));
    }

    #[test]
    fn the_tool_has_the_version_of_the_library() {
        assert_eq!(locked("Cargo.lock"), locked("xtask/bindgen/Cargo.lock"));
    }

    #[test]
    fn the_package_has_the_version_of_the_crates() {
        let json = fs::read_to_string(root().join("crates/sscc-wasm/npm/package.json")).unwrap();
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["version"].as_str(), Some(env!("CARGO_PKG_VERSION")));
    }
}
