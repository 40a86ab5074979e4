//! `cargo xtask public`: counts the public items of the core that a user may have to read.
//!
//! Public items are types, traits, functions, methods, constants, public fields and variants that can be reached from the
//! root. Not counted are the module `parts` and its items, modules, fields of variants, implementations of traits, items of
//! other crates, and items that are hidden from the documentation. Commit 1fcad41, which had no module `parts`, had 387 items
//! by this definition.
//!
//! The items are compared with the list in [`LIST`], which has a reason for each item at the root: a change of the public
//! surface is a change of that file.
//!
//! rustdoc's JSON lists the items. Its format is unstable, so its version is checked.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use serde_json::Value;

use crate::kept_list::{self, KeptList};
use crate::program::{cargo, exit_code, root, usage};

/// The version of rustdoc's JSON that this task reads.
const FORMAT: u64 = 57;

/// The version of Rust that writes this version of the JSON. The workflow installs it.
const RUST: &str = "1.95";

/// The maximum number of items outside of `parts`: 260, plus the items of distances, of intervals of weights, of clearances
/// of certificates, and of two errors.
const MAX_ITEMS: usize = 260 + 21 + 19 + 7;

/// The kept list, below the root of the workspace.
const LIST: &str = "crates/sscc/public-items.txt";

/// Prints the counts of the items, with `--list` also their names. Fails if they differ from the kept list, which `--write`
/// replaces, or if there are more than [`MAX_ITEMS`].
pub fn run(arguments: &[String]) -> ExitCode {
    let (is_listed, is_written) = match arguments {
        [] => (false, false),
        [flag] if flag == "--list" => (true, false),
        [flag] if flag == "--write" => (false, true),
        _ => {
            return usage(
                "public [--list | --write]    (compares the public items of the core with the kept list)",
            );
        }
    };
    let json = match documentation() {
        Ok(json) => json,
        Err(line) => {
            eprintln!("error: {line}");
            return ExitCode::from(2);
        }
    };
    let mut items = Items { index: &json["index"], visited: BTreeSet::new(), found: Vec::new() };
    let root = items.of(&json["root"]);
    let is_parts = |item: &Value| item["name"] == "parts" && item["inner"]["module"].is_object();
    if let Some(parts) = items.children(root).into_iter().find(|item| is_parts(item)) {
        items.visit(parts);
    }
    let parts = std::mem::take(&mut items.found);
    items.visit(root);
    let sum = |found: &[Vec<String>]| found.iter().map(Vec::len).sum::<usize>();
    let (inside, outside) = (sum(&parts), sum(&items.found));
    if is_listed {
        for names in &items.found {
            println!("{:>7}  {}", names.len(), names.join(", "));
        }
    }
    println!("{outside:>7}  outside of parts, at most {MAX_ITEMS}\n{inside:>7}  in parts");
    if outside > MAX_ITEMS {
        return ExitCode::FAILURE;
    }
    exit_code(compare(&items.found, is_written))
}

/// Compares the items with the kept list, or writes it.
fn compare(found: &[Vec<String>], is_written: bool) -> Result<(), String> {
    let path = root().join(LIST);
    let text = fs::read_to_string(&path).map_err(|error| format!("{LIST}: {error}"))?;
    let mut items = kept_list::Items::new();
    for names in found {
        let [name, members @ ..] = &names[..] else { continue };
        let mut members = members.to_vec();
        members.sort();
        items.insert(name.clone(), members);
    }
    let list = KeptList::parse(&text);
    if is_written {
        return fs::write(&path, list.updated(&items)).map_err(|error| format!("{LIST}: {error}"));
    }
    let differences = list.differences(&items);
    differences.iter().for_each(|line| println!("{line}"));
    match differences.is_empty() {
        true => Ok(()),
        false => Err(format!("{LIST} differs (see above); after a review: cargo xtask public --write")),
    }
}

/// Environment variable that is set where cargo runs this program in place of rustdoc.
pub const AS_RUSTDOC: &str = "SSCC_XTASK_AS_RUSTDOC";

/// Runs rustdoc with the arguments of this program and with unstable options allowed. If cargo itself allowed these options,
/// it would compile all dependencies again.
pub fn rustdoc() -> ExitCode {
    let status =
        Command::new("rustdoc").args(std::env::args_os().skip(1)).env("RUSTC_BOOTSTRAP", "1").status();
    match status {
        Ok(status) if status.success() => ExitCode::SUCCESS,
        _ => ExitCode::FAILURE,
    }
}

/// Runs rustdoc, and returns its JSON.
fn documentation() -> Result<Value, String> {
    let program = std::env::current_exe().map_err(|error| error.to_string())?;
    let target = program.parent().and_then(Path::parent).ok_or("the target folder is not known")?;
    let mut command = cargo();
    command.current_dir(root()).env("RUSTDOC", &program).env(AS_RUSTDOC, "1");
    command.args(["rustdoc", "--quiet", "--package", "sscc", "--lib", "--target-dir"]).arg(target);
    command.args(["--", "-Z", "unstable-options", "--output-format", "json", "--cap-lints", "allow"]);
    if !command.status().map_err(|error| error.to_string())?.success() {
        return Err("rustdoc failed".into());
    }
    let path = target.join("doc/sscc.json");
    let text = fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let json: Value =
        serde_json::from_slice(&text).map_err(|error| format!("{}: {error}", path.display()))?;
    match json["format_version"].as_u64() {
        Some(FORMAT) => Ok(json),
        found => Err(format!(
            "rustdoc's JSON has version {}, {FORMAT} was expected: cargo +{RUST} xtask public",
            found.unwrap_or_default()
        )),
    }
}

/// The items of a crate.
struct Items<'j> {
    index: &'j Value,
    /// Numbers of the items that were counted.
    visited: BTreeSet<String>,
    /// The names of each type, trait, function or constant with its fields, variants and methods.
    found: Vec<Vec<String>>,
}

impl<'j> Items<'j> {
    fn of(&self, id: &Value) -> &'j Value {
        &self.index[id.to_string()]
    }

    /// Returns the public items of a module.
    fn children(&self, module: &Value) -> Vec<&'j Value> {
        let items = list(&module["inner"]["module"]["items"]).iter().map(|id| self.of(id));
        items.filter(|item| item["visibility"] == "public").collect()
    }

    /// Counts the public items of a module, or an item with its fields, variants and methods.
    fn visit(&mut self, item: &'j Value) {
        let inner = &item["inner"];
        if inner["module"].is_object() {
            self.children(item).into_iter().for_each(|child| self.visit(child));
        } else if inner["use"].is_object() {
            // An item of another crate is null, and is not counted.
            self.visit(self.of(&inner["use"]["id"]));
        } else if !item.is_null() && self.visited.insert(item["id"].to_string()) {
            let kind = inner.as_object().and_then(|map| map.values().next()).unwrap_or(inner);
            let mut names = vec![text(&item["name"])];
            let fields = [&kind["kind"]["plain"]["fields"], &kind["kind"]["tuple"]];
            let own = fields.into_iter().chain([&kind["variants"]]).flat_map(list);
            let of_traits = list(&kind["items"]).iter();
            let own = own.chain(of_traits).map(|id| self.of(id)).filter(|item| item["visibility"] != "crate");
            names.extend(own.filter(|item| !item.is_null()).map(|item| text(&item["name"])));
            let implementations = list(&kind["impls"]).iter().map(|id| &self.of(id)["inner"]["impl"]);
            let inherent = implementations.filter(|found| found.is_object() && found["trait"].is_null());
            let methods = inherent.flat_map(|found| list(&found["items"])).map(|id| self.of(id));
            names.extend(
                methods.filter(|item| item["visibility"] == "public").map(|item| text(&item["name"])),
            );
            self.found.push(names);
        }
    }
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_workflow_has_the_version_of_rust_that_writes_this_format() {
        let text = fs::read_to_string(root().join(".github/workflows/test.yml")).unwrap();
        let lint = text.split("\n  lint:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap();
        assert!(lint.contains("cargo xtask public"));
        assert!(lint.contains(&format!("RUSTUP_TOOLCHAIN: \"{RUST}\"")));
        assert!(lint.contains(&format!("rustup toolchain install {RUST} ")));
    }
}
