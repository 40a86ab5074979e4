//! `cargo xtask deny`: checks licences, sources and duplicates of all dependencies by `deny.toml`.

use std::process::{Command, ExitCode, Stdio};

use crate::program::{exit_code, root, succeed, usage};

/// Runs cargo-deny; arguments go to it, in place of the checks that need no network.
pub fn run(arguments: &[String]) -> ExitCode {
    if arguments.iter().any(|argument| argument.starts_with('-')) {
        return usage("deny [advisories, bans, licenses or sources]");
    }
    let mut deny = Command::new("cargo-deny");
    let is_installed = deny.arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok();
    if !is_installed {
        return exit_code(Err("cargo-deny is not installed: cargo install --locked cargo-deny".to_owned()));
    }
    let checks: Vec<&str> = match arguments {
        [] => vec!["bans", "licenses", "sources"],
        _ => arguments.iter().map(String::as_str).collect(),
    };
    let mut deny = Command::new("cargo-deny");
    deny.args(["check", "--hide-inclusion-graph"]).args(checks).current_dir(root());
    exit_code(succeed(&mut deny, "a dependency is refused by deny.toml"))
}
