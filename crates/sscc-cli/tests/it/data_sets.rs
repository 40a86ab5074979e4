//! `sscc check` of folders and of several files: bad files do not end the run.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use sscc_testing::models;

use crate::common::sscc;
use crate::detector::{flag, folder as small_files, obj};

/// The four corners and the volume of a tetrahedron, in Medit's and TetGen's formats.
const CORNERS: [&str; 4] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];

fn tetgen(folder: &Path, name: &str) {
    let nodes: String = CORNERS.iter().enumerate().map(|(n, xyz)| format!("{n} {xyz}\n")).collect();
    fs::write(folder.join(name).with_extension("node"), format!("4 3 0 0\n{nodes}")).unwrap();
    fs::write(folder.join(name).with_extension("ele"), "1 4 0\n0 0 1 2 3\n").unwrap();
}

/// A data set of a free and a colliding mesh, solids, a scene, and four files that cannot be checked.
fn data_set(folder: &Path) {
    let set = folder.join("set");
    fs::create_dir_all(set.join("more")).unwrap();
    let write = |name: &str, text: &str| fs::write(set.join(name), text).unwrap();
    write("2.obj", &obj(1.0));
    write("10.obj", &obj(0.0));
    write("broken.ply", "ply\n");
    write("cameras.gltf", r#"{"asset":{"version":"2.0"},"nodes":[{"camera":0}]}"#);
    write("empty.stl", "");
    write("flag.gltf", &flag());
    write("notes.txt", "not a mesh");
    write("points.obj", "v 0 0 0\n");
    write(".hidden.obj", "not a mesh");
    write("more/3.obj", &obj(1.0));
    let vertices = CORNERS.map(|xyz| format!("{xyz} 0\n")).concat();
    write(
        "tet.mesh",
        &format!("MeshVersionFormatted 1\nDimension 3\nVertices 4\n{vertices}Tetrahedra 1\n1 2 3 4 0\nEnd\n"),
    );
    tetgen(&set, "tetgen");
}

#[test]
fn a_folder_is_checked_to_its_end() {
    let directory = tempfile::tempdir().unwrap();
    data_set(directory.path());
    let mut answers: Vec<Vec<Value>> = Vec::new();
    for threads in ["1", "2", "7"] {
        let run = sscc(directory.path(), &["check", "set/", "--json", "--threads", threads]);
        assert_eq!(run.code, Some(2), "{run:?}");
        let [summary, error] = run.stderr.lines().collect::<Vec<_>>()[..] else { panic!("{run:?}") };
        assert!(
            summary.starts_with("note: 5 files: 4 free, 1 colliding, 4 files not checked; median "),
            "{summary}"
        );
        assert!(error.starts_with("error: set/broken.ply: the file ends within the header; "), "{error}");
        assert!(error.ends_with("; 3 more files could not be checked"), "{error}");
        let without_times = |mut line: Value| {
            line.as_object_mut().unwrap().remove("microseconds");
            line
        };
        answers.push(run.json().into_iter().map(without_times).collect());
    }
    assert!(answers.iter().all(|lines| *lines == answers[0]), "in order, on any number of threads");
    let files: Vec<&str> = answers[0].iter().map(|line| line["file"].as_str().unwrap()).collect();
    let names = [
        "2.obj",
        "10.obj",
        "broken.ply",
        "cameras.gltf",
        "empty.stl",
        "flag.gltf",
        "points.obj",
        "tet.mesh",
        "tetgen.node",
    ];
    assert_eq!(files, names.map(|name| format!("set/{name}")));
    let colliding: Vec<&Value> = answers[0].iter().map(|line| &line["colliding"]).collect();
    let (free, hit, bad) = (json!(false), json!(true), Value::Null);
    assert_eq!(colliding, [&free, &hit, &bad, &bad, &bad, &free, &bad, &free, &free]);
    for (name, cause) in [
        ("set/cameras.gltf", "no mesh of the file has triangles: export the scene with its surfaces"),
        ("set/empty.stl", "the file is empty"),
        ("set/points.obj", "the mesh has no triangles"),
    ] {
        assert!(answers[0].contains(&json!({"file": name, "error": cause})), "{name}: {answers:?}");
    }
}

#[test]
fn text_lists_files_with_errors() {
    let directory = tempfile::tempdir().unwrap();
    data_set(directory.path());
    let run = sscc(directory.path(), &["check", "set", "--only", "colliding"]);
    assert_eq!((run.code, run.stderr.lines().count()), (Some(2), 1), "{run:?}");
    assert!(run.stdout.contains("\nset/empty.stl              ERROR      the file is empty\n"), "{run:?}");
    assert!(run.stdout.contains("set/10.obj ") && !run.stdout.contains("set/2.obj "), "{run:?}");
    assert!(run.stdout.contains("\n5 files: 4 free, 1 colliding, 4 files not checked; "), "{run:?}");
    // None of several files can be checked.
    for args in
        [&["missing.obj", "set/2.obj"][..], &["missing.obj", "none.obj"], &["set/empty.stl", "set/more"]]
    {
        let run = sscc(directory.path(), &[&["check"], args].concat());
        let is_error = run.stderr.starts_with("error: ") && run.stderr.lines().count() == 1;
        assert!(run.code == Some(2) && is_error && run.stdout.contains("ERROR"), "{run:?}");
        assert_eq!(run.stdout.lines().count(), 3, "{run:?}");
    }
    // One file alone has no line of its own.
    let alone = sscc(directory.path(), &["check", "set/empty.stl", "--json"]);
    assert!(alone.refusal().ends_with("set/empty.stl: the file is empty"), "{alone:?}");
}

#[test]
fn folders_without_errors() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    data_set(folder);
    let run = sscc(folder, &["check", "set/more", "--json"]);
    assert_eq!((run.code, run.json()[0]["file"].as_str()), (Some(0), Some("set/more/3.obj")), "{run:?}");
    assert!(run.stderr.starts_with("note: 1 file: 1 free, 0 colliding; median "), "{run:?}");
    let run = sscc(folder, &["check", "set/more", "set/10.obj"]);
    assert!(run.code == Some(1) && run.stdout.contains("\n2 files: 1 free, 1 colliding; "), "{run:?}");
    fs::create_dir(folder.join("empty")).unwrap();
    for (args, cause) in [
        (&["empty"][..], "empty: there is no mesh, solid or glTF file in this folder"),
        (&["set/2.obj", "empty"], "empty: there is no mesh, solid or glTF file in this folder"),
        (&["set", "--pose", "a.ply"], "set: --pose is for one mesh: name a file of the folder"),
        (&["set", "--report", "a.html"], "set: --report is for one mesh: name a file of the folder"),
        (&["set", "--frames", "set"], "set: --frames is for one mesh: name a file of the folder"),
        (&["set", "--against", "set/2.obj"], "set: --against is for one mesh: name a file of the folder"),
        (&["set", "--curves", "set/10.obj"], "set/10.obj: the output is an input"),
        (&["set", "--q=0"], "set: unknown kind of mesh file; supported: "),
    ] {
        let run = sscc(folder, &[&["check"], args].concat());
        assert!(run.code == Some(2) && run.stdout.is_empty() && run.stderr.contains(cause), "{run:?}");
    }
}

/// With `--frames`, a folder is one mesh that moves.
#[test]
fn frames_are_no_data_set() {
    let directory = small_files();
    let folder = directory.path();
    let frames = sscc(folder, &["check", "mesh.obj", "--frames", "frames", "--json"]);
    assert!(frames.json().iter().all(|line| line.get("file").is_none()), "{frames:?}");
    let files = sscc(folder, &["check", "frames", "--json"]);
    let pairs = |lines: Vec<Value>| lines.into_iter().map(|line| line["pairs"].clone()).collect::<Vec<_>>();
    assert_eq!((files.code, pairs(files.json())), (frames.code, pairs(frames.json())));
}

#[test]
fn animations_of_several_files() {
    let directory = small_files();
    let folder = directory.path();
    let args = ["check", "flag.gltf", "mesh.obj", "flag.gltf", "--animation=wave", "--times=0,1", "--json"];
    let run = sscc(folder, &args);
    assert_eq!((run.code, run.json().len()), (Some(2), 9), "{run:?}");
    assert_eq!(run.json()[4]["error"], "only .glb, .gltf and .vrm files have animations: give --frames");
}

#[cfg(unix)]
#[test]
fn unreadable_files_do_not_end_the_run() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::create_dir(folder.join("set")).unwrap();
    fs::write(folder.join("set/b.obj"), obj(1.0)).unwrap();
    std::os::unix::fs::symlink("nowhere.obj", folder.join("set/a.obj")).unwrap();
    let run = sscc(folder, &["check", "set", "--json"]);
    assert_eq!(run.json()[0], json!({"file": "set/a.obj", "error": "not found"}));
    assert_eq!((run.code, run.json()[1]["colliding"].as_bool()), (Some(2), Some(false)), "{run:?}");
}

/// Names of files may have line breaks and escape sequences. Text has each on one line; JSON has the names as they are, in answers and
/// in errors.
#[cfg(unix)]
#[test]
fn names_of_files_are_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::create_dir(folder.join("set")).unwrap();
    let names = ["a.obj\nb.obj  12.0 us  free.obj", "b\u{1b}[1m.obj", "c\r.obj"];
    for (name, text) in names.iter().zip([obj(1.0), obj(0.0), "v 0 0\n".to_owned()]) {
        fs::write(folder.join("set").join(name), text).unwrap();
    }
    let run = sscc(folder, &["check", "set"]);
    assert_eq!(
        (run.code, run.stdout.lines().count(), run.stderr.lines().count()),
        (Some(2), 4, 1),
        "{run:?}"
    );
    assert!(!run.stdout.contains(|c: char| c.is_control() && c != '\n'), "{run:?}");
    for shown in [
        r"set/a.obj\nb.obj  12.0 us  free.obj ",
        r"set/b\u{1b}[1m.obj ",
        r"set/c\r.obj              ERROR      line 1: ",
        r"; worst: set/b\u{1b}[1m.obj (1 pair)",
    ] {
        assert!(run.stdout.contains(shown), "{shown}: {run:?}");
    }
    assert!(run.stderr.starts_with(r"error: set/c\r.obj: line 1: "), "{run:?}");
    let lines = sscc(folder, &["check", "set", "--json"]).json();
    let files: Vec<&str> = lines.iter().map(|line| line["file"].as_str().unwrap()).collect();
    assert_eq!(files, names.map(|name| format!("set/{name}")));
    assert!(lines[2]["error"].as_str().is_some_and(|error| error.starts_with("line 1: ")), "{lines:?}");
}

/// An output that is written before an error stays, and is complete.
#[test]
fn outputs_before_an_error_stay() {
    let directory = tempfile::tempdir().unwrap();
    data_set(directory.path());
    let run = sscc(directory.path(), &["check", "set/broken.ply", "set/10.obj", "--curves=c.obj"]);
    assert_eq!((run.code, run.stderr.lines().count()), (Some(2), 1), "{run:?}");
    let curves = fs::read_to_string(directory.path().join("c.obj")).unwrap();
    assert!(curves.starts_with("# contact curves: ") && curves.ends_with('\n'), "{curves}");
}

#[test]
fn published_models_are_a_data_set() {
    let Some(models) = models("published_models_are_a_data_set") else { return };
    let run = sscc(&models, &["check", "skinned", "selfintersecting", "--json"]);
    assert!(run.code == Some(1) && run.json().iter().all(|line| line.get("error").is_none()));
    // The robot is a scene, as if it were checked by itself.
    let is_of_robot = |line: &Value| line["file"] == "skinned/RobotExpressive.glb";
    let of_robot: Vec<Value> = run.json().into_iter().filter(is_of_robot).collect();
    let alone = sscc(&models, &["check", "skinned/RobotExpressive.glb", "--json"]).json();
    let found = |line: &Value| [line["node"].clone(), line["against_node"].clone(), line["pairs"].clone()];
    assert!(of_robot.len() > 14 && of_robot.iter().map(found).eq(alone.iter().map(found)));
    let known = run.json().into_iter().find(|line| line["file"] == "selfintersecting/doubleLoopWithCube.obj");
    assert_eq!(known.unwrap()["count"], 792);
}
