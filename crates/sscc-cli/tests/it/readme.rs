//! The commands of the README run as shown, and its Rust example has the dependencies that it shows.

use std::fs;
use std::path::Path;

/// Returns the only code block in that language.
fn block<'a>(text: &'a str, language: &str) -> &'a str {
    let fence = format!("```{language}\n");
    let mut parts = text.split(&fence);
    let (Some(_), Some(rest), None) = (parts.next(), parts.next(), parts.next()) else {
        panic!("no block of {language}, or several");
    };
    rest.split_once("```").unwrap().0
}

/// The example is compiled as a test of the documentation of `sscc-examples`, which has more dependencies than the
/// README lists.
#[test]
fn the_rust_example_has_its_dependencies() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let (heading, lines) = block(&readme, "toml").split_once('\n').unwrap();
    assert_eq!(heading, "[dependencies]");
    let mut listed = Vec::new();
    for line in lines.lines() {
        let (name, value) = line.split_once(" = ").unwrap();
        let path =
            value.strip_prefix("{ path = \"../sscc/").and_then(|rest| rest.strip_suffix("\" }")).unwrap();
        let manifest = fs::read_to_string(root.join(path).join("Cargo.toml")).unwrap();
        assert!(manifest.contains(&format!("[package]\nname = \"{name}\"\n")), "{line}");
        listed.push(name.replace('-', "_"));
    }
    let code = block(&readme, "rust,no_run");
    let mut used: Vec<&str> = code
        .match_indices("::")
        .map(|(end, _)| code[..end].rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap())
        .filter(|name| name.starts_with("sscc"))
        .collect();
    used.sort_unstable();
    used.dedup();
    assert_eq!(used, listed);
}

/// Returns the words of the lines that begin with `sscc ` in blocks marked `sh`.
pub fn commands(text: &str) -> Vec<Vec<String>> {
    let mut in_block = false;
    let mut commands = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            in_block = line == "```sh";
        } else if let (true, Some(rest)) = (in_block, line.strip_prefix("sscc ")) {
            let (rest, _comment) = rest.split_once("  # ").unwrap_or((rest, ""));
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
