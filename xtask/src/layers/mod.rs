//! `cargo xtask layers`: checks that imports go down the order in `layers.toml`, between crates and between the modules
//! of a crate, that no files of a crate form a circle, and that libraries name no flags of the command.
//!
//! Crates are checked by their dependencies. Within a crate an import is a path from `crate`, `super` or `self`, in a `use` or in
//! code, or from a module that a `use` names. It imports the file that defines the item: re-exports are followed. The task does
//! not know types, so it misses methods. Items and files for tests do not count.

mod flags;
mod imports;
mod order;
mod paths;

use std::path::Path;
use std::process::ExitCode;

use crate::sources::{self, Crate};
use flags::flags;
use imports::Imports;
use order::Order;

/// Checks the layers of this workspace.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        eprintln!("Usage: cargo xtask layers");
        return ExitCode::from(2);
    }
    let violations = match violations(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")) {
        Ok(violations) => violations,
        Err(line) => {
            eprintln!("error: {line}");
            return ExitCode::from(2);
        }
    };
    violations.iter().for_each(|violation| eprintln!("error: {violation}"));
    if violations.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("{} violations of the layers", violations.len());
    ExitCode::FAILURE
}

/// Returns all violations in a workspace, each as one or more lines `file:line: message`.
fn violations(root: &Path) -> Result<Vec<String>, String> {
    let (order, crates) = (Order::read(root)?, sources::read(root)?);
    let mut violations = order.unknown_crates(&crates);
    for krate in &crates {
        let imports = Imports::of(krate);
        violations.extend(dependencies(krate, &order));
        violations.extend(order.unplaced_modules(krate));
        violations.extend(imports.up_the_order(&order));
        violations.extend(imports.circle());
        violations.extend(flags(krate));
    }
    Ok(violations)
}

fn dependencies(krate: &Crate, order: &Order) -> Vec<String> {
    let why = |dependency: &String| {
        let why = order.reason_against("crates", &krate.name, dependency)?;
        Some(format!("{}/Cargo.toml: the crate depends on {dependency}: {why}", krate.folder))
    };
    krate.dependencies.iter().filter_map(why).collect()
}

#[cfg(test)]
mod tests;
