//! `cargo xtask msrv`: checks each crate with the oldest version of Rust that its `rust-version` states. Needs rustup, which
//! downloads these versions once.

use std::collections::BTreeMap;
use std::process::{Command, ExitCode};

use crate::packages;
use crate::program::{exit_code, root, succeed, usage};

/// Checks all crates.
pub fn run(arguments: &[String]) -> ExitCode {
    match arguments {
        [] => exit_code(check()),
        _ => usage("msrv    (checks crates with the oldest version of Rust that they state)"),
    }
}

fn check() -> Result<(), String> {
    let mut versions = BTreeMap::<String, Vec<String>>::new();
    for package in packages::read()? {
        if let Some(version) = package.rust_version {
            versions.entry(version).or_default().push(package.name);
        }
    }
    for (version, names) in versions {
        println!("== Rust {version}: {}", names.join(", "));
        let mut install = Command::new("rustup");
        install.args(["toolchain", "install", &version, "--profile", "minimal", "--no-self-update"]);
        succeed(&mut install, "rustup cannot install this version")?;
        let mut cargo = Command::new("rustup");
        cargo.args(["run", &version, "cargo", "check", "--target-dir"]).arg(root().join("target/msrv"));
        names.iter().for_each(|name| _ = cargo.args(["--package", name]));
        // The variables of the cargo that runs this task name its own compiler.
        for variable in ["CARGO", "RUSTC", "RUSTUP_TOOLCHAIN", "RUSTDOC"] {
            cargo.env_remove(variable);
        }
        succeed(cargo.current_dir(root()), &format!("Rust {version} does not compile them"))?;
    }
    Ok(())
}
