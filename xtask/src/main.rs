//! Tasks of the project, which `cargo xtask` lists. Workflows and `.ci/run` call nothing else.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod c;
mod debian;
mod deny;
mod digests;
mod environment;
mod extension;
mod fuzz;
mod fuzz_record;
mod kept_list;
mod layers;
mod lemmas;
mod lines;
mod lint;
mod msrv;
mod mutants;
mod operators;
mod package;
mod packages;
mod page;
mod program;
mod public;
mod python;
mod semver;
mod serial;
mod site;
mod soundness;
mod sources;
mod tally;
mod test;
mod wasm;
mod wheel;

use std::process::ExitCode;

/// A task: its name, its arguments and purpose, and its function.
type Task = (&'static str, &'static str, fn(&[String]) -> ExitCode);

const TASKS: &[Task] = &[
    (
        "test",
        "[arguments for cargo test]: runs all tests; with arguments, only those of the crates",
        test::run,
    ),
    ("python", "[arguments for pytest]: runs the tests of the Python package", python::run),
    ("page", "[--write | --test]: builds the page and compares it with the one checked in", page::run),
    ("c", "tests programs in C and C++: compilers, sanitizers, valgrind, the installed package", c::run),
    (
        "wasm",
        "[--test [--release]]: builds the package for npm, or tests it in Node and in a browser",
        wasm::run,
    ),
    ("site", "[--with-rustdoc]: builds and checks the site of the documents", site::run),
    ("serial", "tests the core without threads", serial::run),
    ("lint", "checks formatting, lints and documentation", lint::run),
    ("layers", "checks the order of crates, modules and files", layers::run),
    ("lemmas", "proves the rounding lemmas of docs/proofs with Gappa", lemmas::run),
    ("lines", "counts the lines of the product", lines::run),
    ("public", "[--list | --write]: compares the public items of the core with the kept list", public::run),
    (
        "semver",
        "[REVISION]: compares public items of the core and its version, since the last release",
        semver::run,
    ),
    ("mutants", "[names]: checks that the tests catch wrong variants of the core", mutants::run),
    (
        "operators",
        "[--count N] [--seed S] [--seconds T] [--write] [paths]: counts changed operators of the core that tests catch",
        operators::run,
    ),
    (
        "soundness",
        "[--hours H] [--seed S] [--quick] [--write]: compares random answers with exact arithmetic",
        soundness::run,
    ),
    ("fuzz", "[--seconds N] [--write] [targets]: runs readers with inputs of a fuzzer", fuzz::run),
    (
        "digests",
        "[--write]: checks that certificates and answers are the same bytes on every machine",
        digests::run,
    ),
    ("package", "[--verify]: packs the crates that are published", package::run),
    ("wheel", "builds and checks the wheel and the source distribution", wheel::run),
    ("extension", "[WHEEL ...]: packs the add-on of Blender", extension::run),
    ("msrv", "checks crates with the oldest versions of Rust that they state", msrv::run),
    ("deny", "[--advisories]: checks licences and sources of dependencies", deny::run),
    ("help", "prints this list", help),
];

fn main() -> ExitCode {
    if std::env::var_os(public::AS_RUSTDOC).is_some() {
        return public::rustdoc();
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((name, rest)) = arguments.split_first() else { return help(&[]) };
    match TASKS.iter().find(|task| task.0 == name) {
        Some((_, _, run)) => run(rest),
        None => {
            let names: Vec<&str> = TASKS.iter().map(|task| task.0).collect();
            eprintln!("error: no task has the name '{name}'; the tasks are: {}", names.join(", "));
            ExitCode::from(2)
        }
    }
}

fn help(_: &[String]) -> ExitCode {
    eprintln!("Usage: cargo xtask TASK");
    TASKS.iter().for_each(|(name, purpose, _)| eprintln!("  {name:<10} {purpose}"));
    ExitCode::from(2)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use crate::{TASKS, program::root};

    /// Whether a step only installs a tool.
    fn is_installation(line: &str) -> bool {
        let installers = ["cargo install --locked ", "rustup toolchain install ", "sudo apt-get "];
        let is_plain = |c: char| c.is_ascii_alphanumeric() || " -+.".contains(c);
        installers.iter().any(|installer| line.starts_with(installer)) && line.chars().all(is_plain)
    }

    #[test]
    fn steps_that_do_more_than_install_are_not_installations() {
        assert!(is_installation("sudo apt-get install -y g++ libeigen3-dev"));
        for line in ["sudo apt-get update && make", "apt-get update", "make", "sudo apt-get update; ls"] {
            assert!(!is_installation(line), "{line}");
        }
    }

    #[test]
    fn workflows_call_only_tasks() {
        let mut calls = 0;
        for file in fs::read_dir(root().join(".github/workflows")).unwrap() {
            let text = fs::read_to_string(file.unwrap().path()).unwrap();
            for line in
                text.lines().filter_map(|line| line.trim().trim_start_matches("- ").strip_prefix("run: "))
            {
                let task = line.strip_prefix("cargo xtask ").and_then(|rest| rest.split(' ').next());
                let is_task = task.is_some_and(|task| TASKS.iter().any(|(name, ..)| *name == task));
                assert!(is_task || is_installation(line), "{line}");
                calls += usize::from(is_task);
            }
            assert!(!text.contains("run: |"), "steps of several lines are not checked");
        }
        assert!(calls > 8);
    }
}
