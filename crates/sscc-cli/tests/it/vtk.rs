//! Deformed results of FEM in files of VTK: checked, as frames, fitted by modes, and written.

use std::fs;
use std::path::Path;

use serde_json::json;
use tempfile::TempDir;

use crate::common::sscc;

/// Two tetrahedra that are apart; the displacements `u` move the second one into the first (crates/sscc-io/tests/vtk, where they are
/// `U`: those are in `unclear.vtu`).
fn result() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let from = concat!(env!("CARGO_MANIFEST_DIR"), "/../sscc-io/tests/vtk/vtk_raw_zlib.vtu");
    let mut bytes = fs::read(from).unwrap();
    fs::write(directory.path().join("unclear.vtu"), &bytes).unwrap();
    let name = b"Name=\"U\"";
    let at = bytes.windows(name.len()).position(|window| window == name).unwrap();
    bytes[at..at + name.len()].copy_from_slice(b"Name=\"u\"");
    fs::write(directory.path().join("result.vtu"), bytes).unwrap();
    directory
}

fn collection(folder: &Path, name: &str, sets: &[(&str, f64)]) {
    let set = |(file, time): &(&str, f64)| format!("<DataSet timestep='{time}' part='0' file='{file}'/>\n");
    let sets: String = sets.iter().map(set).collect();
    let text = format!(
        "<?xml version='1.0'?>\n<VTKFile type='Collection'><Collection>\n{sets}</Collection></VTKFile>\n"
    );
    fs::write(folder.join(name), text).unwrap();
}

#[test]
fn results_are_checked_as_they_are_deformed() {
    let directory = result();
    let folder = directory.path();
    let deformed = sscc(folder, &["check", "result.vtu", "--json", "--pose=pose.vtu"]);
    assert_eq!(deformed.code, Some(1), "{deformed:?}");
    assert!(
        deformed.stderr.contains("result.vtu: the point data 'u' moves the points (FILE# takes them"),
        "{deformed:?}"
    );
    let pairs = deformed.json()[0]["pairs"].clone();
    let all: Vec<[u32; 2]> = serde_json::from_value(pairs.clone()).unwrap();
    assert!(all.iter().all(|[i, j]| *i < 4 && *j >= 4) && !all.is_empty(), "{all:?}");
    for free in ["result.vtu#", "result.vtu#velocity"] {
        let run = sscc(folder, &["check", free, "--json"]);
        assert_eq!((run.code, run.json()[0]["count"].as_u64()), (Some(0), Some(0)), "{run:?}");
    }
    // The pose is the deformed surface, without displacements of its own.
    let pose = sscc(folder, &["check", "pose.vtu", "--json"]);
    assert_eq!((pose.json()[0]["pairs"].clone(), pose.stderr.as_str()), (pairs, ""));
    let named = sscc(folder, &["check", "result.vtu#T"]);
    assert!(
        named
            .refusal()
            .contains("result.vtu: point data: there are no vectors 'T'; the point data has 'velocity', 'u'")
    );
    // `U` may be a velocity.
    let unclear = sscc(folder, &["check", "unclear.vtu"]);
    assert!(
        unclear.code == Some(0)
            && unclear.stderr.contains("unclear.vtu: the point data 'U' may be displacements or velocities"),
        "{unclear:?}"
    );
    assert_eq!(sscc(folder, &["check", "unclear.vtu#U"]).code, Some(1));
    collection(folder, "unclear.pvd", &[("unclear.vtu", 0.0), ("unclear.vtu", 1.0)]);
    for args in [&["check", "result.vtu#", "--frames=unclear.vtu"][..], &["check", "unclear.pvd"]] {
        let run = sscc(folder, args);
        let lines = run.stderr.matches("the point data 'U' may be displacements or velocities").count();
        assert_eq!((run.code, lines), (Some(0), 1), "{args:?}: {run:?}");
    }
    let info = sscc(folder, &["info", "result.vtu"]);
    assert!(info.code == Some(0) && info.stdout.contains("2 tetrahedra"), "{info:?}");
}

#[test]
fn collections_are_frames_with_times() {
    let directory = result();
    let folder = directory.path();
    // A file without displacements beside the deformed one.
    let rest = sscc(folder, &["check", "result.vtu#", "--pose=rest.vtu"]);
    assert_eq!(rest.code, Some(0), "{rest:?}");
    sscc(folder, &["check", "result.vtu", "--pose=deformed.vtu"]);
    collection(folder, "motion.pvd", &[("deformed.vtu", 0.5), ("rest.vtu", 0.25)]);
    let frames = |args: &[&str]| {
        let run = sscc(folder, &[&["check"], args, &["--json"]].concat());
        let of = |line: &serde_json::Value| (line["time"].clone(), line["colliding"].clone());
        (run.code, run.json().iter().map(of).collect::<Vec<_>>())
    };
    let expected = (Some(1), vec![(json!(0.25), json!(false)), (json!(0.5), json!(true))]);
    assert_eq!(frames(&["motion.pvd"]), expected);
    assert_eq!(frames(&["rest.vtu", "--frames=motion.pvd"]), expected);
    let text = sscc(folder, &["check", "motion.pvd"]).stdout;
    assert!(
        text.contains("frame     1  0.5000 s") && text.contains("2 frames: 1 free, 1 colliding"),
        "{text}"
    );
    // A motion from one to the other.
    assert_eq!(frames(&["motion.pvd", "--continuous"]), (Some(1), vec![(json!(0.25), json!(true))]));
    // Written and read again, with the same times; the colliding frame has marks.
    assert_eq!(frames(&["motion.pvd", "--frames-out=again.pvd"]), expected);
    assert_eq!(frames(&["again.pvd"]), expected);
    assert!(
        frames(&["motion.pvd", "--frames-out=again.npy"]) == expected && folder.join("again.npy").exists()
    );
    let file = |frame: u32| {
        String::from_utf8_lossy(&fs::read(folder.join(format!("again/again_{frame:06}.vtu"))).unwrap())
            .into_owned()
    };
    let marks = |frame: u32| file(frame).split("_\u{8}").nth(1).unwrap()[7..15].matches('\u{1}').count();
    assert_eq!(marks(0), 0);
    assert!(marks(1) > 1);
    assert!(fs::read_to_string(folder.join("again.pvd")).unwrap().contains("timestep=\"0.25\""));

    let refused = |args: &[&str]| sscc(folder, &[&["check"], args].concat()).refusal().to_owned();
    assert_eq!(
        refused(&["motion.pvd", "rest.vtu"]),
        "error: motion.pvd: a collection is checked by itself: leave out rest.vtu"
    );
    collection(folder, "twice.pvd", &[("rest.vtu", 1.0), ("deformed.vtu", 1.0)]);
    assert!(
        refused(&["twice.pvd"])
            .contains("'rest.vtu' and 'deformed.vtu' have the same time 1: a frame is one file")
    );
    collection(folder, "gone.pvd", &[("gone.vtu", 1.0)]);
    assert!(refused(&["gone.pvd"]).ends_with("gone.vtu: not found"));
    fs::write(folder.join("other.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let other = refused(&["other.obj", "--frames=motion.pvd"]);
    assert!(other.contains("the surface of this frame has 8 triangles and 8 vertices"), "{other}");
    assert!(other.contains("the cells must be the same in all frames"), "{other}");
    // Inputs and other files are not overwritten; an earlier collection is replaced.
    let input = "again.pvd: the output is an input; choose another name";
    for args in [["again.pvd"].as_slice(), &["again.pvd#"], &["rest.vtu", "--frames=again.pvd"]] {
        assert!(refused(&[args, &["--frames-out=again.pvd"]].concat()).ends_with(input));
    }
    for args in [
        ["motion.pvd", "--pose=rest.vtu"].as_slice(),
        &["result.vtu#", "--frames=motion.pvd", "--pose=rest.vtu"],
    ] {
        assert_eq!(refused(args), "error: rest.vtu: the output is an input; choose another name");
    }
    for args in [["rest.vtu", "--frames=again"], ["again/again_000000.vtu", "--frames=motion.pvd"]] {
        let message = refused(&[&args[..], &["--frames-out=again.pvd"]].concat());
        assert!(message.contains("again.pvd: its folder has files of the input 'again"), "{message}");
    }
    assert_eq!(frames(&["again.pvd"]), expected);
    assert_eq!(frames(&["motion.pvd", "--frames-out=again.pvd"]), expected);
    fs::write(folder.join("again/notes.txt"), "a").unwrap();
    assert!(refused(&["motion.pvd", "--frames-out=again.pvd"]).contains(
        "again: contains 'notes.txt', which is not a file of an earlier collection 'again.pvd': move it away"
    ));
    assert_eq!(frames(&["again.pvd"]), expected);
    // Readers refuse larger collections, so the command refuses them before it writes a frame.
    sscc_io::write_npy(&folder.join("many.npy"), &[10_001, 8, 3], &vec![0.0; 10_001 * 8 * 3]).unwrap();
    assert!(refused(&["rest.vtu", "--frames=many.npy", "--frames-out=many.pvd"]).ends_with(
        "many.pvd: a collection has at most 10000 frames, but there are 10001: write fewer, or write a .npy file"
    ));
    assert!(!folder.join("many").exists() && !folder.join("many.pvd").exists());
    let output = refused(&["motion.pvd", "--frames-out=x.vtu"]);
    assert_eq!(output, "error: x.vtu: the name of frames must end in .npy or .pvd");
}

#[test]
fn results_are_fitted_by_modes() {
    let directory = result();
    let folder = directory.path();
    // A folder of results is one of target meshes, and of frames.
    fs::create_dir(folder.join("targets")).unwrap();
    fs::copy(folder.join("result.vtu"), folder.join("targets/a.vtu")).unwrap();
    let fit = sscc(folder, &["fit", "result.vtu", "--modes=targets", "result.vtu", "-o", "q.npy", "--json"]);
    let row = &fit.json()[0];
    assert!(
        (row["q"][0].as_f64().unwrap() - 1.0).abs() < 1e-12 && row["residual"].as_f64().unwrap() < 1e-12,
        "{fit:?}"
    );
    let frames = sscc(folder, &["check", "result.vtu#", "--frames=targets", "--json"]);
    assert_eq!(frames.json()[0]["colliding"], true, "{frames:?}");
    let folder_of_files = sscc(folder, &["check", "targets", "--json"]);
    assert_eq!(folder_of_files.json()[0]["colliding"], true, "{folder_of_files:?}");
}
