//! Rows of trajectories and frames as text: their numbers, summaries, and `--only colliding`.

use std::fs;

use serde_json::json;
use sscc_io::write_npy;

use crate::common::{keys, sorted, sscc, strips};

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";

/// The end of a summary with free answers under the default contact filter.
const APART: &str = "; free, apart from pairs with common vertices";

#[test]
fn rows_of_check_have_numbers_and_a_summary() {
    let directory = strips();
    let folder = directory.path();
    write_npy(&folder.join("q.npy"), &[4, 2], &[0.5, 0.0, 1.0, 4.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
    let given = ["check", MODEL, "--certificates", CERTIFICATES, "--trajectory", "q.npy"];
    let run = |more: &[&str]| sscc(folder, &[&given[..], more].concat());
    let text = run(&[]).stdout;
    let lines: Vec<&str> = text.lines().collect();
    let places: Vec<&str> = lines[..4].iter().map(|line| line.split("  |z|").next().unwrap()).collect();
    assert_eq!(places, ["row     0", "row     1", "row     2", "row     3"]);
    let counts =
        run(&["--json"]).json().iter().map(|line| line["count"].as_u64().unwrap()).collect::<Vec<_>>();
    assert!(counts[1] > 0 && counts[3] > counts[1], "{counts:?}");
    let summary = lines[4];
    assert!(
        summary.starts_with(
            "4 configurations: 2 free (2 by the root's certificate alone), 2 colliding; median "
        )
    );
    let worst = format!("; worst: row 3 ({} pairs); rows are counted from 0{APART}", counts[3]);
    assert!(summary.ends_with(&worst), "{summary}");
    // Limited answers do not state which row has the most pairs.
    let first = run(&["--first"]).stdout;
    assert!(!first.contains("worst"), "{first}");
    assert!(first.ends_with(&format!("; rows are counted from 0{APART}\n")), "{first}");
    let steps = run(&["--continuous"]).stdout;
    assert!(steps.starts_with("step     0  |z|") && steps.contains("; worst: step "), "{steps}");
    assert!(steps.ends_with("; steps are counted from 0\n"), "{steps}");
}

#[test]
fn only_colliding_rows_of_check() {
    let directory = strips();
    let folder = directory.path();
    write_npy(&folder.join("q.npy"), &[4, 2], &[0.5, 0.0, 1.0, 4.0, 0.0, 0.0, 1.0, 0.0]).unwrap();
    write_npy(&folder.join("free.npy"), &[2, 2], &[0.5, 0.0, 0.0, 0.0]).unwrap();
    let run = |rows: &str, more: &[&str]| {
        let given = ["check", MODEL, "--certificates", CERTIFICATES, "--trajectory", rows];
        sscc(folder, &[&given[..], more].concat())
    };
    let all = run("q.npy", &["--json"]).json();
    let only = run("q.npy", &["--only", "colliding", "--json"]);
    assert_eq!(only.code, Some(1));
    let only = only.json();
    assert_eq!(only.iter().map(|line| &line["index"]).collect::<Vec<_>>(), [1, 3]);
    for (line, whole) in only.iter().zip([&all[1], &all[3]]) {
        assert_eq!((keys(line), &line["pairs"]), (keys(whole), &whole["pairs"]));
    }
    let text = run("q.npy", &["--only", "colliding"]).stdout;
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len() == 3 && lines[0].starts_with("row     1  ") && lines[1].starts_with("row     3  "));
    assert!(lines[2].starts_with("4 configurations: 2 free"), "{text}");
    // Nothing collides: the summary alone.
    let free = run("free.npy", &["--only", "colliding"]);
    assert!(free.code == Some(0) && free.stdout.starts_with("2 configurations: 2 free"), "{free:?}");
    let free = run("free.npy", &["--only", "colliding", "--json"]);
    assert_eq!((free.code, free.stdout.as_str()), (Some(0), ""));

    // Frames of a mesh, and several meshes.
    let frame =
        |z: f64| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nf 1 2 3\nf 4 5 6\n");
    fs::create_dir(folder.join("frames")).unwrap();
    for (name, z) in [("0", 1.0), ("1", 0.0), ("2", 2.0)] {
        fs::write(folder.join(format!("frames/{name}.obj")), frame(z)).unwrap();
    }
    let run = sscc(folder, &["check", "frames/0.obj", "--frames", "frames", "--only=colliding"]).stdout;
    assert!(run.starts_with("frame     1  ") && run.contains("\n3 frames: 2 free, 1 colliding; "), "{run}");
    let end = format!("; worst: frame 1 (1 pair); frames are counted from 0{APART}\n");
    assert!(run.ends_with(&end), "{run}");
    let depths = sscc(folder, &["check", "frames/0.obj", "--frames", "frames", "--depths"]).stdout;
    assert!(depths.contains("; worst: frame 1 (1 pair, deepest 0)"), "{depths}");
    let files = sscc(folder, &["check", "frames/0.obj", "frames/1.obj", "--only", "colliding"]).stdout;
    assert!(files.starts_with("frames/1.obj  "), "{files}");
    assert!(files.contains("; worst: frames/1.obj (1 pair); free, apart from "), "{files}");
}

#[test]
fn rows_of_resolve_have_numbers_and_a_summary() {
    let directory = strips();
    let folder = directory.path();
    write_npy(&folder.join("q.npy"), &[3, 2], &[0.5, 0.0, 1.0, 0.0, 1.0, 0.25]).unwrap();
    let given = ["resolve", MODEL, "--certificates", CERTIFICATES];
    let run = |more: &[&str]| sscc(folder, &[&given[..], more].concat());
    let changes: Vec<f64> = run(&["--trajectory=q.npy", "--json"])
        .json()
        .iter()
        .map(|line| line["change"].as_f64().unwrap())
        .collect();
    assert!(changes[0] == 0.0 && changes[1] > 0.0 && changes[2] > 0.0, "{changes:?}");
    let worst = if changes[2] > changes[1] { 2 } else { 1 };
    let text = run(&["--trajectory=q.npy"]).stdout;
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "row     0  free as it is");
    assert!(
        lines[1].starts_with("row     1  resolved  change ") && lines[2].starts_with("row     2  resolved  ")
    );
    let summary = format!("3 rows: 1 free as given, 2 resolved, 0 not resolved; worst: row {worst} (change ");
    assert!(lines.len() == 4 && lines[3].starts_with(&summary), "{text}");
    assert!(lines[3].ends_with("; rows are counted from 0; --json prints each free q"), "{text}");

    let only = run(&["--trajectory=q.npy", "--only", "colliding", "--json"]).json();
    assert_eq!(only.iter().map(|line| line["index"].clone()).collect::<Vec<_>>(), [json!(1), json!(2)]);
    assert_eq!(keys(&only[0]), sorted("index, resolved, q, change, safe_scale_change"));
    let only = run(&["--trajectory=q.npy", "--only", "colliding"]).stdout;
    assert!(only.starts_with("row     1  ") && only.lines().count() == 3, "{only}");
}

/// The text has four digits; JSON has all.
#[test]
fn numbers_of_resolve_are_rounded_in_the_text() {
    let directory = strips();
    let folder = directory.path();
    let given = ["resolve", MODEL, "--certificates", CERTIFICATES, "--q=1,0.123456789"];
    let exact = sscc(folder, &[&given[..], &["--json"]].concat()).json()[0]["q"][1].to_string();
    assert!(exact.len() > 10, "{exact}");
    let text = sscc(folder, &given).stdout;
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines.len() == 2 && lines[0].starts_with("resolved  change "), "{text}");
    let numbers = lines[1].strip_prefix("q (rounded; --json prints all digits): ").unwrap();
    assert!(numbers.split(", ").all(|number| number.len() <= 7), "{text}");
    // Weights of named modes.
    fs::create_dir(folder.join("targets")).unwrap();
    let mesh = fs::read_to_string(folder.join("mesh.obj")).unwrap();
    fs::write(folder.join("targets/lower.obj"), mesh.replace(" 1\nv", " -0.5\nv")).unwrap();
    fs::write(folder.join("targets/still.obj"), &mesh).unwrap();
    let text = sscc(folder, &["resolve", "mesh.obj", "--modes", "targets", "--q=lower=0.75"]).stdout;
    assert!(text.contains("): lower=0.") && !text.contains("still"), "{text}");
}
