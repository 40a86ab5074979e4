//! The commands and the Rust example of the README run as shown.

use std::fs;
use std::path::Path;
use std::process::Command;

/// Returns the only code block in that language.
fn block<'a>(text: &'a str, language: &str) -> &'a str {
    let fence = format!("```{language}\n");
    let mut parts = text.split(&fence);
    let (Some(_), Some(rest), None) = (parts.next(), parts.next(), parts.next()) else {
        panic!("no block of {language}, or several");
    };
    rest.split_once("```").unwrap().0
}

/// The example is a project beside a copy of this one. It gets paths of the crates and the lock file, so that nothing
/// is downloaded, and nothing else of the workspace.
#[test]
fn the_rust_example_is_a_project_of_its_own() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let dependencies = block(&readme, "toml");
    assert!(dependencies.lines().skip(1).all(|line| line.contains("\"../sscc/crates/")), "{dependencies}");
    let package = "[package]\nname = \"yours\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n";
    let dependencies = dependencies.replace("../sscc/", &format!("{}/", root.display()));
    fs::write(folder.join("Cargo.toml"), package.to_owned() + &dependencies).unwrap();
    fs::create_dir(folder.join("src")).unwrap();
    fs::write(folder.join("src/main.rs"), block(&readme, "rust")).unwrap();
    fs::copy(root.join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    // In the target folder of the tests, so that a second run finds it compiled.
    let target = Path::new(env!("CARGO_BIN_EXE_sscc")).ancestors().nth(2).unwrap().join("readme");
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .args(["check", "--offline", "--quiet"])
        .env("CARGO_TARGET_DIR", target)
        .current_dir(folder)
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success() && !stderr.contains("warning"), "{stderr}");
}

/// Returns the words of the lines that begin with `sscc ` in blocks marked `sh`.
pub fn commands(text: &str) -> Vec<Vec<String>> {
    let mut in_block = false;
    let mut commands = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            in_block = line == "```sh";
        } else if let (true, Some(rest)) = (in_block, line.strip_prefix("sscc ")) {
            commands.push(rest.split_whitespace().map(str::to_owned).collect());
        }
    }
    commands
}

#[test]
fn commands_of_the_readme() {
    let readme = concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md");
    let commands = commands(&fs::read_to_string(readme).unwrap());
    assert!(commands.len() >= 6, "{commands:?}");
    let directory = tempfile::tempdir().unwrap();
    for args in &commands {
        let run = crate::common::sscc(directory.path(), args);
        // The animation of the demo collides.
        let wanted = if args[0] == "check" { 1 } else { 0 };
        assert_eq!((run.code, run.stderr.as_str()), (Some(wanted), ""), "sscc {}", args.join(" "));
        assert!(!run.stdout.is_empty());
    }
    // The model made again from the written mesh is the same to the last bit.
    let digest =
        |file| crate::common::sscc(directory.path(), &["info", file, "--json"]).json()[0]["digest"].clone();
    assert_eq!(digest("spring.model.safetensors"), digest("demo/spring.sscc.safetensors"));
    let [made, again] = ["demo/spring.sscc.safetensors", "spring.sscc.safetensors"]
        .map(|f| fs::read(directory.path().join(f)).unwrap());
    assert_eq!(made, again);
}

/// Some frames of the demo collide, and the root's certificate proves others free.
#[test]
fn the_demo_shows_all_kinds_of_frames() {
    let directory = tempfile::tempdir().unwrap();
    let run = crate::common::sscc(directory.path(), &["demo", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let report = &run.json()[0];
    assert_eq!((&report["triangles"], &report["mismatches"]), (&16_000.into(), &0.into()));
    for group in report["frames"].as_array().unwrap() {
        assert!(group["frames"].as_u64().unwrap() >= 5, "{group}");
    }
    assert!(crate::common::files(directory.path()).is_empty());
}
