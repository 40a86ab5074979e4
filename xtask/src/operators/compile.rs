//! Compiles all variants at once, in a copy of the workspace.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::program::{cargo, output, root, succeed};

/// Folders and files of the core whose code has variants.
const FOLDERS: [&str; 10] = [
    "arithmetic.rs",
    "bounds",
    "certificates",
    "detect",
    "filter",
    "geometry",
    "hierarchy",
    "model",
    "posed",
    "query",
];

/// Maximum number of compilations in which variants that do not compile are found. The compiler reports errors of borrowing
/// only when all types are right.
const MAX_ROUNDS: usize = 20;

/// Lines between a switch and the code that it selects.
const MAX_DISTANCE: usize = 12;

/// A wrong variant of the code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variant {
    pub number: u32,
    /// The file, relative to `crates/sscc/src`.
    pub file: String,
    pub line: u32,
    pub function: String,
    pub change: String,
}

/// Returns the variants that compile, and the test programs that have them.
pub fn compile() -> Result<(Vec<Variant>, Vec<PathBuf>), String> {
    let folder = root().join("target/operators");
    let workspace = folder.join("workspace");
    copy_workspace(&workspace)?;
    let mut test = tool(&folder, "test");
    succeed(test.stdout(Stdio::null()), "the tests of operators/ fail")?;
    let mut excluded = BTreeSet::new();
    for _ in 0..MAX_ROUNDS {
        let variants = instrument(&folder, &workspace, &excluded)?;
        let wrong = not_compiling(&workspace)?;
        println!("{} variants, of which {} do not compile", variants.len(), wrong.len());
        if wrong.is_empty() {
            return Ok((variants, test_programs(&workspace)?));
        }
        excluded.extend(wrong);
    }
    Err(format!("after {MAX_ROUNDS} compilations some variants still do not compile"))
}

/// Copies the files of the project. A file that is already there with the same content keeps its time.
fn copy_workspace(to: &Path) -> Result<(), String> {
    let mut list = Command::new("git");
    list.args(["ls-files", "--cached", "--others", "--exclude-standard"]).current_dir(root());
    let names = output(&mut list, "the files of the project cannot be listed")?;
    for name in names.lines().filter(|name| !name.starts_with("crates/sscc/src/")) {
        copy(&root().join(name), &to.join(name))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    // A file that was removed, but is still in the index.
    let Ok(bytes) = fs::read(from) else { return Ok(()) };
    if fs::read(to).is_ok_and(|old| old == bytes) {
        return Ok(());
    }
    let written = to.parent().map_or(Ok(()), fs::create_dir_all).and_then(|()| fs::write(to, bytes));
    written.map_err(|error| format!("{}: {error}", to.display()))
}

/// Puts the variants into the copy of the core. Returns all that are not excluded.
fn instrument(folder: &Path, workspace: &Path, excluded: &BTreeSet<u32>) -> Result<Vec<Variant>, String> {
    // Files that are the same as before are not compiled again. Files that are gone have no variants.
    let core = folder.join("core");
    if core.is_dir() {
        fs::remove_dir_all(&core).map_err(|error| format!("{}: {error}", core.display()))?;
    }
    copy_folder(&root().join("crates/sscc/src"), &core)?;
    let (numbers, list) = (folder.join("excluded"), folder.join("variants.tsv"));
    let text = excluded.iter().map(|number| format!("{number}\n")).collect::<String>();
    fs::write(&numbers, text).map_err(|error| format!("{}: {error}", numbers.display()))?;
    let mut run = tool(folder, "run");
    run.arg("--").args([&core, &numbers, &list]).args(FOLDERS);
    succeed(&mut run, "the variants cannot be made")?;
    copy_folder(&core, &workspace.join("crates/sscc/src"))?;
    let text = fs::read_to_string(&list).map_err(|error| format!("{}: {error}", list.display()))?;
    text.lines().map(|line| variant(line).ok_or_else(|| format!("not a variant: {line}"))).collect()
}

/// Returns cargo's command `run` or `test` for the program that makes the variants.
fn tool(folder: &Path, command: &str) -> Command {
    let mut tool = cargo();
    tool.args([command, "--quiet", "--locked", "--manifest-path"]).arg(root().join("operators/Cargo.toml"));
    tool.arg("--target-dir").arg(folder.join("tool"));
    tool
}

fn copy_folder(from: &Path, to: &Path) -> Result<(), String> {
    let entries = fs::read_dir(from).map_err(|error| format!("{}: {error}", from.display()))?;
    for entry in entries.flatten() {
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() { copy_folder(&from, &to)? } else { copy(&from, &to)? }
    }
    Ok(())
}

fn variant(line: &str) -> Option<Variant> {
    let [number, file, line, function, change] = line.split('\t').collect::<Vec<_>>().try_into().ok()?;
    Some(Variant {
        number: number.parse().ok()?,
        file: file.replace('\\', "/"),
        line: line.parse().ok()?,
        function: function.to_owned(),
        change: change.to_owned(),
    })
}

/// Returns the variants in which the compiler finds an error.
fn not_compiling(workspace: &Path) -> Result<BTreeSet<u32>, String> {
    let mut check = cargo();
    check.args(["check", "--quiet", "-p", "sscc", "--lib", "--message-format=json"]);
    let compiler = in_copy(&mut check, workspace)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| format!("cargo cannot be run: {error}"))?;
    let mut wrong = BTreeSet::new();
    for line in String::from_utf8_lossy(&compiler.stdout).lines() {
        let message = serde_json::from_str::<Value>(line).unwrap_or_default()["message"].take();
        if message["level"] != "error" || message["spans"].as_array().is_none_or(Vec::is_empty) {
            continue;
        }
        let found = message["spans"].as_array().into_iter().flatten().find_map(|span| {
            let text = fs::read_to_string(workspace.join(span["file_name"].as_str()?)).ok()?;
            switch_before(&text, span["line_start"].as_u64()? as usize)
        });
        match found {
            Some(number) => wrong.insert(number),
            None => return Err(format!("an error without a variant: {}", message["rendered"])),
        };
    }
    match compiler.status.success() || !wrong.is_empty() {
        true => Ok(wrong),
        false => Err("the copy of the core does not compile (see above)".to_owned()),
    }
}

/// Returns the number of the last switch at or before a line, which is counted from 1.
fn switch_before(text: &str, line: usize) -> Option<u32> {
    let lines: Vec<&str> = text.lines().take(line).collect();
    lines.iter().rev().take(MAX_DISTANCE).find_map(|line| {
        let (_, after) = line.rsplit_once("switch::is_on(")?;
        after.split_once("u32")?.0.parse().ok()
    })
}

/// Compiles the tests of the core. Returns the programs.
fn test_programs(workspace: &Path) -> Result<Vec<PathBuf>, String> {
    let mut test = cargo();
    test.args(["test", "-p", "sscc", "--lib", "--test", "it", "--no-run", "--message-format=json"]);
    let text = output(in_copy(&mut test, workspace), "the tests cannot be compiled with the variants")?;
    let programs = text.lines().filter_map(|line| {
        let message: Value = serde_json::from_str(line).ok()?;
        message["profile"]["test"].as_bool().filter(|is_test| *is_test)?;
        Some(PathBuf::from(message["executable"].as_str()?))
    });
    Ok(programs.collect())
}

/// Makes cargo build in the copy, with a cache of its own, and without warnings.
fn in_copy<'c>(command: &'c mut Command, workspace: &Path) -> &'c mut Command {
    let cache = root().join("target/operators/build");
    command.current_dir(workspace).env("CARGO_TARGET_DIR", cache).env("RUSTFLAGS", "-Awarnings")
}

#[cfg(test)]
mod tests {
    use super::{switch_before, variant};

    #[test]
    fn an_error_belongs_to_the_switch_before_it() {
        let text = "if crate::switch::is_on(7u32) {\n    return 0;\n}\nif crate::switch::is_on(8u32) {";
        assert_eq!([1, 2, 4].map(|line| switch_before(text, line)), [Some(7), Some(7), Some(8)]);
        assert_eq!(switch_before("return 0;", 1), None);
    }

    #[test]
    fn variants_have_five_parts() {
        let found = variant("3\tfilter/rings.rs\t20\tcontain\t+ -> -").unwrap();
        assert_eq!((found.number, found.line, found.change.as_str()), (3, 20, "+ -> -"));
        assert_eq!(variant("3\tfilter/rings.rs\t20"), None);
    }
}
