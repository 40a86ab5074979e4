//! `cargo xtask deny`: checks licences and sources of all dependencies by `deny.toml`.

use std::process::{Command, ExitCode, Stdio};

use crate::program::{exit_code, root, succeed, usage};

/// The checks that need no database from the network.
const CHECKS: [&str; 3] = ["bans", "licenses", "sources"];

/// Runs cargo-deny.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        return usage("deny    (checks licences and sources of all dependencies)");
    }
    let mut deny = Command::new("cargo-deny");
    let is_installed = deny.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !is_installed {
        return exit_code(Err("cargo-deny is not installed: cargo install --locked cargo-deny".to_owned()));
    }
    let mut deny = Command::new("cargo-deny");
    deny.args(["check", "--hide-inclusion-graph"]).args(CHECKS).current_dir(root());
    exit_code(succeed(&mut deny, "a dependency is refused by deny.toml"))
}
