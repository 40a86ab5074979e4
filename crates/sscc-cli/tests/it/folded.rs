//! `sscc check MESH --neighbours include-folded`, and commands that refuse it.

use std::fs;

use serde_json::json;
use sscc_io::write_npy;

use crate::common::{sscc, strips};

/// The model in the folder of [`strips`].
const MODEL: &str = "strips.model.safetensors";

/// The certificates in the folder of [`strips`].
const CERTIFICATES: &str = "strips.sscc.safetensors";

/// A triangle folded onto its neighbour, a hinge that is open, and a face that is there twice.
const MESH: &str = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0.5 0.5 0\nv 0 -1 1\nf 1 2 3\nf 2 1 4\nf 1 5 2\nf 3 1 2\n";

#[test]
fn folded_neighbours_and_doubled_faces_are_listed_on_request() {
    let folder = strips();
    let folder = folder.path();
    fs::write(folder.join("fold.obj"), MESH).unwrap();
    let check = |args: &[&str]| sscc(folder, &[&["check", "fold.obj"], args].concat());
    for rule in ["exclude", "include-one-vertex"] {
        assert_eq!(check(&["--neighbours", rule]).code, Some(0), "{rule}");
    }
    let run = check(&["--neighbours=include-folded", "--json"]);
    assert_eq!((run.code, &run.json()[0]["pairs"]), (Some(1), &json!([[0, 1], [0, 3], [1, 3]])), "{run:?}");
    // Opened, the hinge is free; the doubled face is not.
    let open = MESH.replace("0.5 0.5 0\n", "0.5 0.5 1\n");
    let positions = |text: &str| -> Vec<f64> {
        let rows = text.lines().filter_map(|line| line.strip_prefix("v "));
        rows.flat_map(|row| row.split(' ').map(|x| x.parse().unwrap())).collect()
    };
    let frames = [positions(MESH), positions(&open)].concat();
    write_npy(&folder.join("frames.npy"), &[2, 5, 3], &frames).unwrap();
    let run = check(&["--neighbours=include-folded", "--frames=frames.npy", "--json"]);
    assert_eq!(run.json().iter().map(|line| line["count"].clone()).collect::<Vec<_>>(), [3, 1]);
    let run = check(&["--neighbours=include-folded", "--frames=frames.npy", "--ignore-rest"]);
    assert_eq!(run.code, Some(0));
    assert!(run.stdout.trim_end().ends_with("; free, apart from 3 ignored pairs"), "{run:?}");
    // Nothing is left out.
    fs::write(folder.join("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let run = sscc(folder, &["check", "one.obj", "--neighbours=include-folded"]);
    assert!(run.stdout.starts_with("free: proven\n"), "{run:?}");
}

#[test]
fn certificates_models_and_motions_refuse_folded_neighbours() {
    let folder = strips();
    let folder = folder.path();
    fs::write(folder.join("fold.obj"), MESH).unwrap();
    write_npy(&folder.join("frames.npy"), &[2, 5, 3], &[0.0; 30]).unwrap();
    for args in [
        &["certify", MODEL, "-o", "x.sscc.safetensors"][..],
        &["check", MODEL, "--q=0,0"],
        &["check", MODEL, "--q=0,0", "--method=brute-force"],
        &["check", MODEL, "--q=0,0", "--certificates", CERTIFICATES],
        &["check", "fold.obj", "--frames=frames.npy", "--continuous"],
        &["sweep", MODEL],
    ] {
        let run = sscc(folder, &[args, &["--neighbours=include-folded"]].concat());
        let refusal = run.refusal();
        assert!(
            refusal.contains("include-folded is for discrete queries of meshes without modes"),
            "{args:?}: {refusal}"
        );
        assert!(refusal.ends_with("use include-one-vertex"), "{args:?}: {refusal}");
    }
}
