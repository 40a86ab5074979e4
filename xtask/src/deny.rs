//! `cargo xtask deny [--advisories]`: checks licences and sources of all dependencies by `deny.toml`, those of `fuzz/` and
//! `operators/` included; with the flag also whether advisories are known, from a database that is downloaded.

use std::process::{Command, ExitCode, Stdio};

use crate::program::{exit_code, root, succeed, usage};

/// The checks that need no database from the network.
const CHECKS: [&str; 3] = ["bans", "licenses", "sources"];

/// The workspaces.
const MANIFESTS: [&str; 3] = ["Cargo.toml", "fuzz/Cargo.toml", "operators/Cargo.toml"];

/// Runs cargo-deny.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(deny(&CHECKS)),
        [flag] if flag == "--advisories" => exit_code(deny(&["advisories"]).and_then(|()| deny(&CHECKS))),
        _ => usage("deny [--advisories]    (checks licences and sources of all dependencies)"),
    }
}

fn deny(checks: &[&str]) -> Result<(), String> {
    let mut version = Command::new("cargo-deny");
    if version.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_err() {
        return Err("cargo-deny is not installed: cargo install --locked cargo-deny".to_owned());
    }
    for manifest in MANIFESTS {
        let mut deny = Command::new("cargo-deny");
        deny.args(["--manifest-path", manifest, "--config", "deny.toml", "check", "--hide-inclusion-graph"]);
        succeed(deny.args(checks).current_dir(root()), &format!("a dependency of {manifest} is refused"))?;
    }
    Ok(())
}
