//! The commands that the README shows work as shown.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;

/// Lines that begin with `sscc ` in the blocks marked `sh`.
fn commands(text: &str) -> Vec<Vec<String>> {
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
        let run = common::sscc(directory.path(), args);
        // The animation of the demo collides.
        let wanted = if args[0] == "check" { 1 } else { 0 };
        assert_eq!((run.code, run.stderr.as_str()), (Some(wanted), ""), "sscc {}", args.join(" "));
        assert!(!run.stdout.is_empty());
    }
    // A mesh written and read again, and its modes made anew, is the same model to the last bit.
    let digest = |file| common::sscc(directory.path(), &["info", file, "--json"]).json()[0]["digest"].clone();
    assert_eq!(digest("spring.model.safetensors"), digest("demo/spring.sscc.safetensors"));
    let [made, again] = ["demo/spring.sscc.safetensors", "spring.sscc.safetensors"]
        .map(|f| fs::read(directory.path().join(f)).unwrap());
    assert_eq!(made, again);
}

/// What the demo says of itself: part of the frames collide, part are proven free by one comparison.
#[test]
fn the_demo_shows_all_kinds_of_frames() {
    let directory = tempfile::tempdir().unwrap();
    let run = common::sscc(directory.path(), &["demo", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let report = &run.json()[0];
    assert_eq!((&report["triangles"], &report["mismatches"]), (&16_000.into(), &0.into()));
    for group in report["frames"].as_array().unwrap() {
        assert!(group["frames"].as_u64().unwrap() >= 5, "{group}");
    }
    assert!(common::files(directory.path()).is_empty());
}
