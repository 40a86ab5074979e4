//! `sscc check` of meshes without modes: invalid input, and flags that contradict each other.

use std::fs;

use sscc_io::write_npy;

use crate::common::{files, sscc};
use crate::detector::{folder, frames, obj};

#[test]
fn invalid_frames_and_animations_are_refused() {
    let directory = folder();
    let folder = directory.path();
    let good = fs::read(folder.join("frames.npy")).unwrap();
    fs::write(folder.join("cut.npy"), &good[..good.len() - 8]).unwrap();
    for (name, bad) in [("nan.npy", f64::NAN), ("inf.npy", f64::INFINITY), ("far.npy", 1e70)] {
        let mut numbers = frames(&[1.0, 0.5]);
        numbers[25] = bad;
        write_npy(&folder.join(name), &[2, 6, 3], &numbers).unwrap();
    }
    write_npy(&folder.join("short.npy"), &[2, 5, 3], &[0.0; 30]).unwrap();
    write_npy(&folder.join("flat.npy"), &[2, 18], &[0.0; 36]).unwrap();
    write_npy(&folder.join("none.npy"), &[0, 6, 3], &[]).unwrap();
    write_npy(&folder.join("two.npy"), &[2, 6, 3], &frames(&[1.0, 0.5])).unwrap();
    write_npy(&folder.join("one.npy"), &[6, 3], &frames(&[1.0])).unwrap();
    for (name, text) in [
        ("other", obj(0.0).replace("f 4 5 6", "f 5 4 6")),
        ("longer", obj(0.0) + "v 1 1 1\n"),
        ("broken", "v 0 0\n".into()),
    ] {
        fs::create_dir(folder.join(name)).unwrap();
        fs::write(folder.join(name).join("1.obj"), obj(1.0)).unwrap();
        fs::write(folder.join(name).join("2.obj"), text).unwrap();
    }
    fs::create_dir(folder.join("empty")).unwrap();
    // Without the second frame the motion would go from the first one to the third one.
    fs::create_dir(folder.join("gap")).unwrap();
    for name in ["1.obj", "2.glb", "3.obj"] {
        fs::write(folder.join("gap").join(name), obj(1.0)).unwrap();
    }
    for (frames, named) in [
        ("missing.npy", "missing.npy: not found"),
        ("missing", "missing: not found"),
        (
            "mesh.obj",
            "unknown kind of frame file; supported: .npy of shape (T, V, 3), .pc2, .pvd, .vtu, .vtk, and a folder of meshes",
        ),
        ("cut.npy", "568 bytes follow: is the file cut off?"),
        ("nan.npy", "nan.npy: frame 1: vertex 2 (counted from 0) has the position [0.0, NaN, "),
        ("inf.npy", "inf.npy: frame 1: vertex 2 "),
        ("far.npy", "far.npy: frame 1: vertex 2 "),
        ("short.npy", "short.npy: the frames have 5 vertices, the mesh has 6: are they of another mesh?"),
        ("flat.npy", "flat.npy: shape [2, 18]: (T, 6, 3) was expected"),
        ("none.npy", "none.npy: shape [0, 6, 3]: "),
        ("other", "2.obj: triangle 1 (counted from 0) of this frame differs from the mesh (mesh.obj)"),
        ("longer", "2.obj: this frame has 7 vertices, the mesh (mesh.obj) has 6"),
        ("broken", "2.obj: line 1: "),
        (
            "empty",
            "empty: there is no frame mesh in this folder: frames are .obj, .off, .ply, .stl, .vtu or .vtk",
        ),
        (
            "gap",
            "gap: 2.glb is no frame: frames are .obj, .off, .ply, .stl, .vtu or .vtk; convert it or move it away",
        ),
    ] {
        let run = sscc(folder, &["check", "mesh.obj", "--frames", frames, "--json"]);
        // The first frame has no answer: standard output stays empty.
        assert!(run.refusal().contains(named), "{run:?}");
    }
    let refused = |args: &[&str], named: &str| {
        let run = sscc(folder, &[&["check"], args].concat());
        assert!(run.refusal().contains(named), "{run:?}");
    };
    refused(
        &["mesh.obj", "--frames=one.npy", "--continuous"],
        "there is one frame; a motion needs at least two",
    );
    let against = ["mesh.obj", "--frames=two.npy", "--against=lower.obj", "--against-frames=frames.npy"];
    refused(&against, "frames.npy: the frames have 6 vertices, the mesh has 3");
    let against = ["mesh.obj", "--frames=two.npy", "--against=frames/2.obj", "--against-frames=frames.npy"];
    refused(&against, "there are 2 frames, but 4 of the other mesh: as many are needed, or one");
    for (args, named) in [
        (
            &["--animation=run"][..],
            "there is no animation 'run'; the animations of the file, by number: 0 'wave', 1 'still'",
        ),
        (
            &["--animation=2"],
            "there is no animation '2'; the animations of the file, by number: 0 'wave', 1 'still'",
        ),
        (&["--animation=still"], "animations[1]: it has no key frames"),
        (&["--animation=0", "--node=0"], "node 0 shows no mesh with triangles; these nodes do: 1, 2 'moved'"),
        (&["--animation=0", "--fps=0"], "0 frames per second: a finite number above 0 was expected"),
        (&["--animation=0", "--fps=1e9"], "1e9 frames in 1 s: at most 1e7 are allowed"),
        (&["--animation=0", "--times=0,nan"], "the time NaN is not finite"),
        (&["--animation=0", "--times=0", "--continuous"], "there is one frame; a motion needs at least two"),
        (&["--mesh-name=other"], "there is no mesh 'other'; meshes with triangles: 'flag'"),
    ] {
        refused(&[&["flag.gltf"], args].concat(), named);
    }
    refused(
        &["mesh.obj", "--animation=0"],
        "mesh.obj: only .glb, .gltf and .vrm files have animations: give --frames",
    );
    refused(&["mesh.obj", "--mesh-name=a"], "only a glTF file can have several meshes");
}

#[test]
fn invalid_groups_are_refused() {
    let directory = folder();
    let folder = directory.path();
    write_npy(&folder.join("three.npy"), &[3], &[0.0, 0.0, 1.0]).unwrap();
    fs::write(folder.join("mesh.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap();
    for (args, named) in [
        (
            &["mesh.obj", "--ignore-groups=a,b"][..],
            "--ignore-groups a,b: no triangle is in a group 'a'; groups: 'default'",
        ),
        (&["mesh.obj", "--only-groups=default"], "--only-groups default: two groups A,B were expected"),
        (&["mesh.obj", "--group-by=material"], "--group-by: it changes nothing without --ignore-groups"),
        (&["mesh.off", "--only-groups=a,b"], "mesh.off: files of this kind have no groups of triangles"),
        (
            &["mesh.obj", "--only-groups=0,1", "--group-by=three.npy", "--frames=frames"],
            "three.npy: there are groups of 3 triangles, but the mesh has 2",
        ),
        (
            &["flag.gltf", "--animation=0", "--only-groups=0,1", "--group-by=three.npy"],
            "three.npy: there are groups of 3 triangles, but node 1 has 2",
        ),
        (
            &["flag.gltf", "--animation=0", "--only-groups=moved,a", "--group-by=object"],
            "--only-groups moved,a: no triangle is in a group 'a'; groups: '#1', 'moved'",
        ),
        (&["mesh.obj", "--against=lower.obj", "--ignore-groups=a,b"], "no triangle is in a group 'a'"),
    ] {
        let run = sscc(folder, &[&["check"], args].concat());
        assert!(run.refusal().contains(named), "{run:?}");
    }
}

#[test]
fn files_of_curves_that_cannot_be_written_are_refused() {
    let directory = folder();
    let folder = directory.path();
    let before = fs::read(folder.join("lower.obj")).unwrap();
    for (args, named) in [
        (&["--curves=c.stl"][..], "c.stl: the name of contact curves must end in .ply or .obj"),
        (&["--curves=no/c.obj"], "no/c.obj: cannot be written"),
        (&["--curves=mesh.obj"], "mesh.obj: the output is an input"),
        (&["--against=lower.obj", "--curves=lower.obj"], "lower.obj: the output is an input"),
        (&["lower.obj", "--curves=lower.obj"], "lower.obj: the output is an input"),
        (&["--pose=c.obj", "--curves=c.obj"], "--pose and --curves name the same file"),
        (&["--pose=./c.obj", "--curves=frames/../c.obj"], "--pose and --curves name the same file"),
        (&["--frames=frames", "--continuous", "--curves=c.obj"], "cannot be used with"),
        (&["--frames=frames", "--continuous", "--depths"], "cannot be used with"),
        (&["--first", "--curves=c.obj"], "cannot be used with"),
        (&["missing.obj", "--curves=c.obj"], "missing.obj: not found"),
    ] {
        let run = sscc(folder, &[&["check", "mesh.obj"], args].concat());
        assert_eq!((run.code, run.stderr.lines().count()), (Some(2), 1), "{run:?}");
        assert!(run.stderr.contains(named), "{run:?}");
    }
    assert_eq!(fs::read(folder.join("lower.obj")).unwrap(), before);
    assert!(!folder.join("c.obj").exists());
}

/// The meshes of a folder are inputs, and a new one would be a frame, or a mesh of the data set, of the next run.
#[test]
fn meshes_of_input_folders_are_not_replaced_or_added() {
    let directory = folder();
    let folder = directory.path();
    let before = (files(&folder.join("frames")), fs::read(folder.join("frames/2.obj")).unwrap());
    let replaced = "frames/2.obj: the output is an input; choose another name";
    let added = |name: &str, input: &str| {
        format!("{name}: the output would be a mesh of the input folder {input}; choose another folder")
    };
    for (args, named) in [
        (&["mesh.obj", "--frames=frames", "--curves=frames/2.obj"][..], replaced.to_owned()),
        (&["mesh.obj", "--frames=frames", "--pose=frames/2.obj"], replaced.to_owned()),
        (
            &["mesh.obj", "--against=mesh.obj", "--against-frames=frames", "--curves=frames/2.obj"],
            replaced.to_owned(),
        ),
        (&["frames", "--curves=frames/2.obj"], replaced.to_owned()),
        (&["mesh.obj", "--frames=frames", "--pose=frames/12.ply"], added("frames/12.ply", "frames")),
        (&["mesh.obj", "--frames=frames/", "--pose=frames/12.vtu"], added("frames/12.vtu", "frames/")),
        (
            &["mesh.obj", "--frames=frames", "--curves=./frames/../frames/12.obj"],
            added("./frames/../frames/12.obj", "frames"),
        ),
        (&["frames", "--curves=frames/12.obj"], added("frames/12.obj", "frames")),
        (&["mesh.obj", "frames", "--curves=frames/12.obj"], added("frames/12.obj", "frames")),
    ] {
        let run = sscc(folder, &[&["check"], args].concat());
        assert_eq!(run.refusal(), format!("error: {named}"));
    }
    assert_eq!(before.0, files(&folder.join("frames")));
    assert_eq!(before.1, fs::read(folder.join("frames/2.obj")).unwrap());
    // Files that no run reads as frames.
    let others = ["--frames-out=frames/copy.npy", "--report=frames/report.html"];
    for _ in 0..2 {
        let run = sscc(folder, &[&["check", "mesh.obj", "--frames=frames", "--json"], &others[..]].concat());
        assert_eq!((run.code, run.json().len()), (Some(1), 4), "{run:?}");
    }
}

/// Players show a mesh with a scale of zero, so the check continues, with one warning.
#[test]
fn scales_of_zero_are_warned_about() {
    let directory = folder();
    let folder = directory.path();
    let flat = crate::detector::flag().replace("\"name\":\"moved\"", "\"name\":\"moved\",\"scale\":[1,1,0]");
    fs::write(folder.join("flat.gltf"), flat).unwrap();
    for threads in ["--threads=1", "--threads=3"] {
        let run = sscc(folder, &["check", "flat.gltf", "--animation=0", "--json", threads]);
        assert_eq!((run.code, run.json().len()), (Some(0), 62), "{run:?}");
        assert_eq!(
            run.stderr,
            "warning: flat.gltf: node 2: a scale of 0 flattens the mesh at some time, so that its triangles touch\n"
        );
    }
}

#[test]
fn flags_that_contradict_each_other_are_refused() {
    let directory = folder();
    let folder = directory.path();
    for (args, named) in [
        (
            &["--q=0"][..],
            "a mesh has no modes: add --modes FILE, or compute modes with sscc modes; sscc check without",
        ),
        (&["--trajectory=frames.npy"], "a mesh has no modes: "),
        (&["--modes=modes.npy"], "a model deforms by modes: add --q or --trajectory"),
        (&["--method=bdtree"], "--method is for models with modes: add --q or --trajectory, or leave it out"),
        (&["--certificates=x.sscc.safetensors"], "--certificates is for models with modes: "),
        (&["--metric=mass"], "--metric is for models with modes: "),
        (
            &["--continuous"],
            "--continuous: a mesh at rest has no motion: add --frames, --animation or --trajectory",
        ),
        (&["--ignore-rest"], "--ignore-rest: the mesh is at rest: add --frames or --animation"),
        (
            &["--against=lower.obj", "--weld"],
            "--against: neighbours are those of one mesh: leave out --neighbours, --weld and --ignore-rest",
        ),
        (&["--frames=frames.npy", "--q=0"], "cannot be used with"),
        (&["--frames=frames.npy", "--animation=0"], "cannot be used with"),
        (&["--frames=frames.npy", "--fps=10"], "--fps has an effect only with --animation"),
        (&["--frames=frames.npy", "--times=0"], "--times has an effect only with --animation"),
        (&["--frames=frames.npy", "--node=1"], "--node has an effect only with --animation"),
        (&["--frames=frames.npy", "--weights=as-stored"], "--weights has an effect only with --animation"),
        (&["--fps=10"], "--animation"),
        (&["--against-frames=frames.npy"], "--against"),
        (&["lower.obj", "--against=lower.obj"], "cannot be used with"),
        (&["lower.obj", "--pose=a.ply"], "cannot be used with"),
        (&["lower.obj", "--frames=frames.npy"], "frames.npy: belongs to one mesh: leave out lower.obj"),
        (&["lower.obj", "--q=0"], "lower.obj: --q and --trajectory take one model: leave it out"),
    ] {
        let run = sscc(folder, &[&["check", "mesh.obj"], args].concat());
        assert_eq!((run.code, run.stdout.as_str(), run.stderr.lines().count()), (Some(2), "", 1), "{run:?}");
        assert!(run.stderr.contains(named), "{run:?}");
    }
    fs::write(folder.join("m.npz"), "").unwrap();
    let run = sscc(folder, &["check", "m.npz"]);
    assert!(run.refusal().contains("m.npz: a model deforms by modes: add --q or --trajectory"), "{run:?}");
}
