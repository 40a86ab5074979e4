//! `sscc load` and `sscc fit`: from a load or positions to q.

use std::fs;

use glam::DVec3;
use serde_json::json;
use sscc_io::write_npy;

use crate::common::sscc;

/// A bar of 60 x 8 x 20 mm.
pub const BRACKET: &str = "v 0 0 0\nv 60 0 0\nv 60 8 0\nv 0 8 0\nv 0 0 20\nv 60 0 20\nv 60 8 20\nv 0 8 20\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

const MODEL: &str = "bracket.model.safetensors";

fn folder() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("bracket.obj"), BRACKET).unwrap();
    let linear =
        ["--kind", "linear", "--rank", "8", "--resolution", "24", "--units", "mm", "--material", "nylon"];
    let args = ["modes", "bracket.obj", "-o", MODEL, "--fix", "box:-1,-1,-1,0,50,50"];
    assert_eq!(sscc(folder, &[&args[..], &linear].concat()).code, Some(0));
    let polynomial = ["modes", "bracket.obj", "-o", "plain.model.safetensors", "--kind", "polynomial"];
    assert_eq!(sscc(folder, &polynomial).code, Some(0));
    directory
}

/// The commands of `docs/command.md`.
#[test]
fn a_load_gives_q_and_positions_give_it_back() {
    let directory = folder();
    let folder = directory.path();
    let guide = include_str!("../../../../docs/command.md");
    let section = guide.split("## From a load or displacements to q").nth(1).unwrap();
    let block = section.split("```").nth(1).unwrap();
    let commands: Vec<Vec<&str>> =
        block.lines().skip(1).map(|line| line.split(' ').skip(1).collect()).collect();
    assert_eq!(commands.len(), 3, "{block}");
    let load = sscc(folder, &[&commands[0][..], &["--json"]].concat());
    assert_eq!(load.code, Some(0), "{load:?}");
    let load = load.json().remove(0);
    let q: Vec<f64> = load["q"].as_array().unwrap().iter().map(|q| q.as_f64().unwrap()).collect();
    // A cantilever of nylon bends by F l^3 / (3 E I) under 10 N at its end; its weight of 0.1 N adds 0.4%.
    let expected = 10.0 * 0.06_f64.powi(3) / (3.0 * 3.0e9 * 0.008 * 0.02_f64.powi(3) / 12.0);
    let ratio = load["largest_displacement"].as_f64().unwrap() / expected;
    assert!(ratio > 0.8 && ratio < 1.1, "{ratio}");
    assert_eq!(sscc(folder, &commands[1]).code, Some(0));

    let (model, _) = sscc_io::read_model(&folder.join(MODEL)).unwrap();
    let positions = |q: &[f64]| -> Vec<DVec3> {
        let moved = |v: u32| model.modes().of_vertex(v).iter().zip(q).map(|(u, q)| *u * *q).sum::<DVec3>();
        (0..8).map(|v| model.mesh().rest_positions()[v as usize] + moved(v)).collect()
    };
    let flat = |p: Vec<DVec3>| p.iter().flat_map(|p| p.to_array()).collect::<Vec<f64>>();
    let wanted = flat(positions(&q));
    write_npy(&folder.join("measured.npy"), &[8, 3], &wanted).unwrap();
    let fit = sscc(folder, &[&commands[2][..], &["--json"]].concat());
    let fit = fit.json().remove(0);
    assert!(fit["residual"].as_f64().unwrap() < 1e-9 && fit["index"] == json!(0), "{fit}");
    let fitted: Vec<f64> = fit["q"].as_array().unwrap().iter().map(|q| q.as_f64().unwrap()).collect();
    let found = flat(positions(&fitted));
    assert!(wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!(sscc_io::read_vector(&folder.join("fitted.npy")).unwrap(), fitted);

    // Two frames, the second one at rest.
    let both = [wanted, flat(positions(&[0.0; 8]))].concat();
    write_npy(&folder.join("measured.npy"), &[2, 8, 3], &both).unwrap();
    let text = sscc(folder, &commands[2]);
    assert!(
        text.stdout.starts_with("frame     0  0.0000% of the displacements remain, at most "),
        "{text:?}"
    );
    assert!(text.stdout.ends_with("2 frames, counted from 0; written: fitted.npy\n"));
    assert_eq!(sscc_io::read_rows(&folder.join("fitted.npy")).unwrap().iter().count(), 2);
}

#[test]
fn loads_and_positions_that_do_not_fit_are_refused() {
    let directory = folder();
    let folder = directory.path();
    write_npy(&folder.join("few.npy"), &[7, 3], &[0.0; 21]).unwrap();
    for (args, named) in [
        (&["load", MODEL, "-o", "q.npy"][..], "--force or --gravity is needed"),
        (
            &["load", MODEL, "-o", "q.npy", "--force", "8:1,0,0"],
            "bracket.model.safetensors: there is no vertex 8",
        ),
        (&["load", MODEL, "-o", "q.npy", "--force", "1:1,0"], "three numbers were expected"),
        (&["load", MODEL, "-o", "q.npy", "--force", "1:1,0,nan"], "three numbers were expected"),
        (&["load", MODEL, "-o", "q.npy", "--force", "x:1,0,0"], "VERTEX:FX,FY,FZ was expected"),
        (
            &["load", MODEL, "-o", "q.npy", "--force", "1:1e80,0,0"],
            "the load has no answer that is a shape: its vertices",
        ),
        (&["load", MODEL, "-o", "q.txt", "--gravity"], "must end in .npy"),
        (
            &["load", "plain.model.safetensors", "-o", "q.npy", "--gravity"],
            "the model has no stiffness: compute it",
        ),
        (&["fit", MODEL, "few.npy", "-o", "q.npy"], "few.npy: "),
        (&["fit", MODEL, "none.npy", "-o", "q.npy"], "none.npy: not found"),
    ] {
        let run = sscc(folder, args);
        assert!(run.refusal().contains(named), "{run:?}");
        assert!(!folder.join("q.npy").exists());
    }
    let far = sscc(folder, &["load", MODEL, "-o", "q.npy", "--force", "1:0,0,-5000"]);
    assert!(far.stderr.contains("note: the answer is linear, and "), "{far:?}");
}

#[test]
fn modes_are_not_overwritten() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("bracket.obj"), BRACKET).unwrap();
    write_npy(&folder.join("modes.npy"), &[24, 1], &[1.0; 24]).unwrap();
    write_npy(&folder.join("positions.npy"), &[1, 8, 3], &[0.5; 24]).unwrap();
    let before = fs::read(folder.join("modes.npy")).unwrap();
    let model = ["bracket.obj", "--modes", "modes.npy"];
    for (command, more) in [("fit", &["positions.npy"][..]), ("load", &["--force", "0:1,0,0"])] {
        let run = sscc(folder, &[&[command], &model[..], more, &["-o", "modes.npy"]].concat());
        assert!(run.refusal().contains("modes.npy: the output is an input"), "{run:?}");
        assert_eq!(fs::read(folder.join("modes.npy")).unwrap(), before);
    }
}
