//! Invalid input of every kind: one line with file and cause, exit code 2, no output, no panic.

use std::fs;
use std::path::Path;

use sscc_io::container::{CERTIFICATES, ContainerWriter, Kind, MODEL};
use sscc_io::write_npy;

use crate::common::{files, sscc, strips};

const MESH: &str = "mesh.obj";
const STRIPS: &str = "strips.model.safetensors";
const CERTIFIED: &str = "strips.sscc.safetensors";

/// Asserts that a command is refused with a message that contains each of `named`, and leaves no file.
fn refused(folder: &Path, args: &[&str], named: &[&str]) {
    let before = files(folder);
    let run = sscc(folder, args);
    let message = run.refusal();
    for part in named {
        assert!(message.contains(part), "{args:?}: {message} does not contain '{part}'");
    }
    assert_eq!(files(folder), before, "{args:?}");
}

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    fs::write(folder.join(name), bytes).unwrap();
}

#[test]
fn files_that_are_not_models_are_refused() {
    let directory = strips();
    let folder = directory.path();
    let good = fs::read(folder.join(STRIPS)).unwrap();
    write(folder, "empty.obj", "");
    write(folder, "latin.obj", b"v 0 0 \xe9\n");
    write(folder, "mesh.stl2", "solid");
    write(folder, "nan.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write(folder, "huge.obj", "v 0 0 1e300\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write(folder, "range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
    write(folder, "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    write(folder, "none.glb", "glTF");
    write(folder, "none.gltf", "{}");
    write(folder, "still.gltf", r#"{"asset":{"version":"2.0"},"meshes":[]}"#);
    write(folder, "none.npz", "PK");
    write(folder, "none.stl", "solid\nfacet\n");
    write(folder, "cut.model.safetensors", &good[..good.len() - 7]);
    write(folder, "short.model.safetensors", &good[..20]);
    write(folder, "empty.model.safetensors", "");
    for (model, named) in [
        ("missing.obj", "missing.obj: not found"),
        ("missing.model.safetensors", "missing.model.safetensors: not found"),
        (".", "unknown kind of mesh file"),
        ("empty.obj", "empty.obj: the file is empty"),
        ("latin.obj", "latin.obj: line 1: "),
        ("mesh.stl2", "mesh.stl2: unknown kind of mesh file; supported: "),
        ("nan.obj", "nan.obj: line 1: 'nan' is not a finite number"),
        ("huge.obj", "huge.obj: vertex 0"),
        ("range.obj", "range.obj: "),
        ("points.obj", "points.obj: the mesh has no triangles"),
        ("cut.model.safetensors", "cut.model.safetensors: the file is damaged"),
        ("short.model.safetensors", "short.model.safetensors: not a file written by sscc"),
        ("empty.model.safetensors", "empty.model.safetensors: the file is empty"),
        ("none.glb", "none.glb: "),
        ("none.gltf", "none.gltf: "),
        ("none.npz", "none.npz: "),
        ("none.stl", "none.stl: "),
        (CERTIFIED, "this is a certificate file, a model file was expected"),
        (MESH, "mesh.obj: a mesh has no modes: add --modes FILE, or compute modes with sscc modes"),
    ] {
        refused(folder, &["certify", model, "-o", "out.sscc.safetensors"], &[named]);
        refused(folder, &["check", model, "--q=0,0"], &[named]);
        refused(folder, &["audit", model, "--certificates", CERTIFIED], &[named]);
        if model != MESH && model != CERTIFIED {
            refused(folder, &["info", model], &[named]);
        }
        if model.ends_with("obj") && model != MESH {
            refused(folder, &["modes", model, "-o", "out.model.safetensors", "--kind=polynomial"], &[named]);
        }
    }
}

/// Every command and every reader reports that a file is missing, before it checks the kind of the file.
#[test]
fn missing_files_are_reported() {
    let directory = strips();
    let folder = directory.path();
    let modes = ["modes", "-o", "out.model.safetensors", "--kind"];
    let certify = ["certify", "-o", "out.sscc.safetensors"];
    for args in [
        &["certify", "missing.xyz", "-o", "out.sscc.safetensors"][..],
        &["certify", "missing.xyz", "-o", "out.sscc.safetensors", "--modes", "modes.npy"],
        &["certify", "missing.xyz", "-o", "out.sscc.safetensors", "--mesh-name", "a"],
        &["certify", "missing.glb", "-o", "out.sscc.safetensors", "--modes", "modes.npy"],
        &[&certify[..], &[MESH, "--modes", "missing.xyz"]].concat(),
        &[&certify[..], &[STRIPS, "--metric", "missing.xyz"]].concat(),
        &[&certify[..], &[STRIPS, "--center", "missing.xyz"]].concat(),
        &["check", "missing.xyz", "--q=0,0"],
        &["check", STRIPS, "--trajectory", "missing.xyz"],
        &["check", STRIPS, "--q=0,0", "--certificates", "missing.xyz"],
        &["audit", "missing.xyz", "--certificates", CERTIFIED],
        &["audit", STRIPS, "--certificates", "missing.xyz"],
        &["info", "missing.xyz"],
        &["info", "missing.veg"],
        &["info", "missing"],
        &["info", "missing.node"],
        &[&modes[..], &["linear", "missing.xyz"]].concat(),
        &[&modes[..], &["linear", "missing.veg", "--resolution", "3"]].concat(),
        &[&modes[..], &["polynomial", "missing.xyz"]].concat(),
        &[&modes[..], &["polynomial", "missing.obj", "--resolution", "3"]].concat(),
        &[&modes[..], &["pca", "missing.xyz"]].concat(),
        &[&modes[..], &["linear", MESH, "--fix", "missing.xyz"]].concat(),
        &["view", "missing.xyz", "--no-open"],
        &["simulate", "missing.xyz", "--cache", "cache"],
    ] {
        refused(folder, args, &["missing", ": not found"]);
    }
}

#[test]
fn requests_for_meshes_that_a_file_does_not_have_are_refused() {
    let directory = strips();
    let folder = directory.path();
    write(folder, "still.gltf", r#"{"asset":{"version":"2.0"},"meshes":[{"name":"a","primitives":[]}]}"#);
    for (args, named) in [
        (&["still.gltf"][..], "still.gltf: no mesh of the file has morph targets"),
        (&["still.gltf", "--mesh-name", "a"], "still.gltf: the mesh 'a' has no morph targets"),
        (&["still.gltf", "--mesh-name", "b"], "still.gltf: there is no mesh 'b'"),
        (&["still.gltf", "--modes", "modes.npy"], "a model file has its own modes: leave out --modes"),
        (&[MESH, "--modes", "modes.npy", "--mesh-name", "a"], "only a glTF file can have several meshes"),
        (&[MESH, "--modes", "."], ": "),
    ] {
        refused(folder, &[&["certify"], args, &["-o", "out.sscc.safetensors"]].concat(), &[named]);
    }
}

#[test]
fn modes_that_do_not_fit_are_refused() {
    let directory = strips();
    let folder = directory.path();
    let header = |rows: i32, rank: i32| [rows.to_le_bytes(), rank.to_le_bytes()].concat();
    write_npy(&folder.join("other.npy"), &[9, 2], &[0.0; 18]).unwrap();
    write_npy(&folder.join("rank0.npy"), &[72, 0], &[]).unwrap();
    let mut values = [0.0; 72];
    for (name, bad) in [("nan.npy", f64::NAN), ("inf.npy", f64::INFINITY), ("far.npy", 1e70)] {
        values[40] = bad;
        write_npy(&folder.join(name), &[72, 1], &values).unwrap();
    }
    write(folder, "huge.U", header(i32::MAX, i32::MAX));
    write(folder, "negative.U", header(-72, 2));
    write(folder, "rank0.U", header(72, 0));
    write(folder, "other.U", [header(9, 1), vec![0; 72]].concat());
    write(folder, "empty.npy", "");
    write(folder, "text.npy", "0 0 0");
    write(folder, "modes.csv", "0 0 0");
    write(folder, "huge.npy", {
        let text = "{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 4), }\n";
        [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()].concat()
    });
    for (modes, named) in [
        ("missing.npy", "missing.npy: not found"),
        ("modes.csv", "modes.csv: unknown kind of modes file; supported: "),
        ("other.npy", "other.npy: the modes are for 3 vertices, the mesh has 24: are they of another mesh?"),
        ("other.U", "other.U: the modes are for 3 vertices, the mesh has 24: are they of another mesh?"),
        ("rank0.npy", "rank0.npy: "),
        ("rank0.U", "rank0.U: "),
        ("nan.npy", "nan.npy: mode 0 of vertex 13 "),
        ("inf.npy", "inf.npy: mode 0 of vertex 13 "),
        ("far.npy", "far.npy: mode 0 of vertex 13 "),
        ("huge.U", "huge.U: byte 8: the header declares 2147483647 rows"),
        ("negative.U", "negative.U: byte 0: a negative number of rows"),
        ("empty.npy", "empty.npy: the file is empty"),
        ("text.npy", "text.npy: "),
        ("huge.npy", "huge.npy: "),
    ] {
        let model = [MESH, "--modes", modes];
        refused(folder, &[&["certify"], &model[..], &["-o", "out.sscc.safetensors"]].concat(), &[named]);
        refused(folder, &[&["check"], &model[..], &["--q=0"]].concat(), &[named]);
    }
    let both = ["certify", STRIPS, "--modes", "modes.npy", "-o", "out.sscc.safetensors"];
    refused(folder, &both, &["a model file has its own modes: leave out --modes"]);
}

#[test]
fn coordinates_that_do_not_fit_are_refused() {
    let directory = strips();
    let folder = directory.path();
    let check = ["check", STRIPS, "--certificates", CERTIFIED];
    for (q, named) in [
        ("--q=1", "--q: q has 1 entries, the model has 2 modes"),
        ("--q=1,2,3", "--q: q has 3 entries, the model has 2 modes"),
        ("--q=0,nan", "--q: q[1] is NaN: every entry must be finite"),
        ("--q=-inf,0", "--q: q[0] is -inf: every entry must be finite"),
        ("--q=1e300,0", "--q: q moves vertices beyond 2^200"),
    ] {
        refused(folder, &[&check[..], &[q]].concat(), &[named]);
    }
    write_npy(&folder.join("long.npy"), &[2, 3], &[0.0; 6]).unwrap();
    write_npy(&folder.join("nan.npy"), &[3, 2], &[0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN]).unwrap();
    write_npy(&folder.join("none.npy"), &[0, 2], &[]).unwrap();
    write_npy(&folder.join("cube.npy"), &[1, 1, 2], &[0.0; 2]).unwrap();
    write(folder, "q.csv", "0,0\n");
    for (trajectory, named) in [
        ("missing.npy", "missing.npy: not found"),
        ("long.npy", "long.npy: row 0 (counted from 0): q has 3 entries, the model has 2 modes"),
        ("nan.npy", "nan.npy: row 2 (counted from 0): q[1] is NaN"),
        ("none.npy", "none.npy: shape [0, 2]"),
        ("cube.npy", "cube.npy: shape [1, 1, 2]"),
        ("q.csv", "q.csv: unknown kind of trajectory file; supported: .npy"),
    ] {
        // Rows before the invalid one have no answers: standard output stays empty.
        refused(folder, &[&check[..], &["--trajectory", trajectory]].concat(), &[named]);
        refused(folder, &[&check[..], &["--trajectory", trajectory, "--json"]].concat(), &[named]);
    }
}

#[test]
fn metrics_that_do_not_fit_are_refused() {
    let directory = strips();
    let folder = directory.path();
    for (name, text) in
        [("short", "1"), ("zero", "1 0"), ("negative", "1 -1"), ("nan", "1 nan"), ("tiny", "1e-300 1")]
    {
        write(folder, name, text);
    }
    write_npy(&folder.join("inf.npy"), &[2], &[1.0, f64::INFINITY]).unwrap();
    for (metric, named) in [
        ("energy", "--metric energy: the model's own metric is displacement, not energy; make a model"),
        ("missing.npy", "missing.npy: not found"),
        ("short", "short: the metric has 1 weights, the model has 2 modes"),
        ("zero", "zero: metric weight 1 (counted from 0) is 0: weights must be positive"),
        ("negative", "negative: metric weight 1 "),
        ("nan", "nan: line 1: 'nan' is not a finite number"),
        ("tiny", "--metric tiny: the modes divided by the metric's scales reach "),
        ("inf.npy", "inf.npy: metric weight 1 (counted from 0) is inf"),
    ] {
        refused(folder, &["certify", STRIPS, "-o", "out.sscc.safetensors", "--metric", metric], &[named]);
        refused(folder, &["check", STRIPS, "--q=0,0", "--metric", metric], &[named]);
    }
}

#[test]
fn certificates_that_do_not_fit_are_refused() {
    let directory = strips();
    let folder = directory.path();
    let check = |certificates: &str, named: &[&str]| {
        refused(folder, &["check", STRIPS, "--certificates", certificates, "--q=0,0"], named);
        refused(folder, &["audit", STRIPS, "--certificates", certificates], named);
    };
    // The same mesh with other modes.
    let modes: Vec<f64> = (0..144).map(|i| if i == 100 { 1e-300 } else { 0.0 }).collect();
    write_npy(&folder.join("other.npy"), &[72, 2], &modes).unwrap();
    let certify = ["certify", MESH, "--modes", "other.npy", "-o", "other.sscc.safetensors"];
    assert_eq!(sscc(folder, &certify).code, Some(0));
    check(
        "other.sscc.safetensors",
        &["other.sscc.safetensors: the certificates are of another model", "certify"],
    );

    let good = fs::read(folder.join(CERTIFIED)).unwrap();
    for at in [0, 9, 100, good.len() / 2, good.len() - 1] {
        let mut flipped = good.clone();
        flipped[at] ^= 4;
        write(folder, "flipped.sscc.safetensors", flipped);
        check("flipped.sscc.safetensors", &["flipped.sscc.safetensors: ", "damaged"]);
    }
    write(folder, "cut.sscc.safetensors", &good[..good.len() - 1]);
    check("cut.sscc.safetensors", &["cut.sscc.safetensors: the file is damaged"]);
    check("missing.sscc.safetensors", &["missing.sscc.safetensors: not found"]);
    check(STRIPS, &["strips.model.safetensors: this is a model file, a certificate file was expected"]);
    check(MESH, &["mesh.obj: not a file written by sscc"]);
    let newer =
        |kind: Kind| ContainerWriter::new(Kind { version: kind.version + 1, ..kind }).finish().unwrap();
    write(folder, "newer.sscc.safetensors", newer(CERTIFICATES));
    write(folder, "newer.model.safetensors", newer(MODEL));
    let named = ["written by a newer sscc (format version ", "): update sscc"];
    check("newer.sscc.safetensors", &named);
    refused(folder, &["info", "newer.sscc.safetensors"], &named);
    refused(folder, &["info", "newer.model.safetensors"], &named);
    refused(folder, &["check", "newer.model.safetensors", "--q=0"], &named);
}

/// A forged file: the digest is that of this model, and the hierarchy that of another.
#[test]
fn forged_certificates_are_refused() {
    let directory = strips();
    let folder = directory.path();
    write(folder, "one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_npy(&folder.join("one.npy"), &[9, 2], &[1.0; 18]).unwrap();
    let certify = ["certify", "one.obj", "--modes", "one.npy", "-o", "one.sscc.safetensors"];
    assert_eq!(sscc(folder, &certify).code, Some(0));
    let mut parts = sscc_io::read_certificates(&folder.join("one.sscc.safetensors")).unwrap().parts().clone();
    let (model, _) = sscc_io::read_model(&folder.join(STRIPS)).unwrap();
    parts.digest = sscc::parts::Digest::of(&model, &parts.scope);
    let forged = sscc::Certificates::try_from(parts).unwrap();
    sscc_io::write_certificates(&folder.join("forged.sscc.safetensors"), &forged).unwrap();
    let args = ["check", STRIPS, "--certificates", "forged.sscc.safetensors", "--q=0,0"];
    refused(folder, &args, &["forged.sscc.safetensors: "]);
}

#[test]
#[cfg(unix)]
fn warnings_are_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    write(folder, "two\nlines.obj", "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3 4\n");
    for command in ["check", "info"] {
        let run = sscc(folder, &[command, "two\nlines.obj"]);
        assert!(run.stderr.starts_with(r"warning: two\nlines.obj: 1 of the 1 faces"), "{run:?}");
        assert_eq!(run.stderr.lines().count(), 1, "{run:?}");
    }
}

#[test]
fn outputs_that_cannot_be_written_are_refused() {
    let directory = strips();
    let folder = directory.path();
    fs::create_dir(folder.join("taken.sscc.safetensors")).unwrap();
    for (output, named) in [
        ("out.npz", "out.npz: the name of the output must end in .sscc.safetensors"),
        ("out.safetensors", "must end in .sscc.safetensors"),
        (".sscc.safetensors", "must end in .sscc.safetensors"),
        ("nowhere/out.sscc.safetensors", "nowhere/out.sscc.safetensors: cannot be written"),
        ("taken.sscc.safetensors", "taken.sscc.safetensors: cannot be written"),
    ] {
        refused(folder, &["certify", STRIPS, "-o", output], &[named]);
    }
    let modes = |source, output, named: &str| {
        refused(folder, &["modes", source, "-o", output, "--kind=polynomial"], &[named]);
    };
    modes(MESH, "out.sscc.safetensors", "must end in .model.safetensors");
    modes(STRIPS, STRIPS, "the output is an input; choose another name");
    write(folder, "demo", "a file");
    refused(folder, &["demo", "--out", "demo"], &["demo: cannot write to this folder"]);
}
