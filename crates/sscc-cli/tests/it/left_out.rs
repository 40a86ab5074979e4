//! The pairs that an answer "free" leaves out, in the text and the JSON of `sscc check` and in reports.

use std::fs;
use std::path::Path;

use serde_json::json;
use sscc_io::write_npy;
use tempfile::TempDir;

use crate::common::sscc;
use crate::detector::{flag, obj};

/// A triangle in a plane, and one whose tip touches it at rest. The mode lifts the second one.
fn touching() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let mesh = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 0\nv 1 1 2\nv 2 1 2\nf 1 2 3\nf 4 5 6\n";
    fs::write(directory.path().join("mesh.obj"), mesh).unwrap();
    let lift: Vec<f64> = (0..18).map(|row| if row >= 9 && row % 3 == 2 { 1.0 } else { 0.0 }).collect();
    write_npy(&directory.path().join("modes.npy"), &[18, 1], &lift).unwrap();
    directory
}

fn certify(folder: &Path, name: &str, flags: &[&str]) {
    let args = ["certify", "mesh.obj", "--modes", "modes.npy", "-o", name];
    let run = sscc(folder, &[&args[..], flags].concat());
    assert_eq!(run.code, Some(0), "{run:?}");
}

/// Every kind of sweep names the pairs that it does not test, even if only the certificates list them.
#[test]
fn sweeps_name_ignored_pairs() {
    let directory = touching();
    let folder = directory.path();
    certify(folder, "ignored.sscc.safetensors", &["--ignore-rest"]);
    certify(folder, "all.sscc.safetensors", &[]);
    let untested = "not tested: 1 ignored pair and pairs with common vertices\n";
    for kind in [&[][..], &["--intervals=3"], &["--combinations"]] {
        let sweep = |certificates: &str, json: &[&str]| {
            let args = ["sweep", "mesh.obj", "--modes", "modes.npy", "--certificates", certificates];
            sscc(folder, &[&args[..], kind, json].concat())
        };
        assert!(sweep("ignored.sscc.safetensors", &[]).stdout.ends_with(untested), "{kind:?}");
        let json = sweep("ignored.sscc.safetensors", &["--json"]);
        assert_eq!(json.stderr, format!("note: {untested}"), "{kind:?}");
        let all = sweep("all.sscc.safetensors", &[]);
        assert!(!format!("{}{}", all.stdout, all.stderr).contains("not tested"), "{all:?}");
    }
}

#[test]
fn free_names_ignored_pairs_and_exceptions_of_certificates() {
    let directory = touching();
    let folder = directory.path();
    certify(folder, "exceptions.sscc.safetensors", &[]);
    certify(folder, "ignored.sscc.safetensors", &["--ignore-rest"]);
    certify(folder, "one.sscc.safetensors", &["--neighbours=include-one-vertex"]);
    let check = |file: &str, flags: &[&str]| {
        let args = ["check", "mesh.obj", "--modes", "modes.npy", "--certificates", file, "--q=0.01"];
        let run = sscc(folder, &[&args[..], flags].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        run
    };
    let first = |file: &str| check(file, &[]).stdout.lines().next().unwrap().to_owned();
    let line = first("exceptions.sscc.safetensors");
    assert!(
        line.starts_with("free: proven by the root's certificate and tests of 1 exception (|z| = "),
        "{line}"
    );
    assert!(line.ends_with("), apart from pairs with common vertices"), "{line}");
    let line = first("ignored.sscc.safetensors");
    assert!(line.starts_with("free: proven by the root's certificate alone (|z| = "), "{line}");
    assert!(line.ends_with("), apart from 1 ignored pair and pairs with common vertices"), "{line}");
    assert!(first("one.sscc.safetensors").ends_with("), apart from pairs with a common edge"));

    let line = check("ignored.sscc.safetensors", &["--json"]).json().remove(0);
    assert_eq!((&line["ignored"], line.get("exceptions")), (&json!(1), None));
    assert_eq!(line["left_out"], json!("1 ignored pair and pairs with common vertices"));
    let line = check("exceptions.sscc.safetensors", &["--json"]).json().remove(0);
    assert_eq!((line.get("ignored"), &line["exceptions"], line.get("left_out")), (None, &json!(1), None));

    write_npy(&folder.join("q.npy"), &[2, 1], &[0.01, 0.02]).unwrap();
    let args = ["check", "mesh.obj", "--modes", "modes.npy", "--trajectory", "q.npy", "--ignore-rest"];
    let run = sscc(folder, &args);
    let apart = "; free, apart from 1 ignored pair and pairs with common vertices";
    assert!(run.stdout.trim_end().ends_with(apart), "{run:?}");
}

#[test]
fn free_names_meshes_that_were_not_compared() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("a.obj"), obj(1.0)).unwrap();
    fs::write(folder.join("b.obj"), obj(9.0)).unwrap();
    fs::write(folder.join("flag.gltf"), flag()).unwrap();
    let last = |args: &[&str]| {
        let run = sscc(folder, &[&["check"], args].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        run.stdout.trim_end().lines().last().unwrap().to_owned()
    };
    let line = last(&["flag.gltf", "--animation", "0", "--report", "flag.html"]);
    assert!(
        line.ends_with("; free, apart from pairs of different nodes and pairs with common vertices"),
        "{line}"
    );
    let report = fs::read_to_string(folder.join("flag.html")).unwrap();
    let data = report.split_once("id=\"sscc-report\">").unwrap().1;
    assert!(data.contains(r#"["not tested","pairs of different nodes and pairs with common vertices"]"#));
    assert!(
        data.contains(r#""apart":", apart from pairs of different nodes and pairs with common vertices""#)
    );
    let line = last(&["flag.gltf", "--animation", "0", "--node", "1"]);
    assert!(line.ends_with("; free, apart from pairs with common vertices"), "{line}");
    let line = last(&["a.obj", "b.obj"]);
    assert!(
        line.ends_with("; free, apart from pairs of different files and pairs with common vertices"),
        "{line}"
    );
    fs::write(folder.join("far.obj"), "v 0 0 50\nv 1 0 50\nv 0 1 50\nf 1 2 3\n").unwrap();
    assert_eq!(
        sscc(folder, &["check", "a.obj", "--against", "far.obj"]).stdout.lines().next(),
        Some("free: proven, apart from pairs within either mesh")
    );
}
