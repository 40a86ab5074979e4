//! `sscc check` of meshes without modes: at rest, in frames, in animations, and against other meshes.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use sscc_io::write_npy;
use tempfile::TempDir;

use crate::common::{Run, keys, sorted, sscc};

const KEYS: &str = "index, norm, colliding, count, complete, pairs, microseconds, root_certified, proof, opened, box_tests, \
                    triangle_tests";

/// Two triangles, the second at the given height.
pub fn obj(z: f64) -> String {
    format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nf 1 2 3\nf 4 5 6\n")
}

/// Positions of these frames.
pub fn frames(heights: &[f64]) -> Vec<f64> {
    let frame = |z: &f64| [0.0, *z].map(|z| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]].concat()).concat();
    heights.iter().flat_map(frame).collect()
}

/// A folder with `mesh.obj`, two triangles 1 apart; `frames.npy` and `frames/` with four heights; `lower.obj`, one
/// triangle below; `flag.gltf`, the two triangles with an animation that lowers one of its two nodes.
pub fn folder() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("mesh.obj"), obj(1.0)).unwrap();
    fs::write(folder.join("lower.obj"), "v 0 0 -1\nv 1 0 -1\nv 0 1 1\nf 1 2 3\n").unwrap();
    let heights = [1.0, 0.5, 0.0, -0.5];
    write_npy(&folder.join("frames.npy"), &[4, 6, 3], &frames(&heights)).unwrap();
    fs::create_dir(folder.join("frames")).unwrap();
    for (name, z) in ["2.obj", "03.off", "10.obj", "11.obj"].iter().zip(heights) {
        let text = obj(z);
        let text = match name.strip_suffix(".off") {
            None => text,
            Some(_) => {
                let vertices = text.lines().filter_map(|line| line.strip_prefix("v ")).collect::<Vec<_>>();
                format!("OFF\n6 2 0\n{}\n3 0 1 2\n3 3 4 5\n", vertices.join("\n"))
            }
        };
        fs::write(folder.join("frames").join(name), text).unwrap();
    }
    fs::write(folder.join("flag.gltf"), flag()).unwrap();
    directory
}

/// Node 1 shows the two triangles, split along the diagonal of a square: they touch unless they are welded. Node 2 shows
/// them as well, and is animated.
pub fn flag() -> String {
    let square = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0_f32]];
    let floats = square.iter().flat_map(|[x, y]| [*x, *y, 0.0]).chain([0.0, 1.0]);
    let moved = [0.0, 0.0, 0.0, 0.0, 0.0, 5.0_f32];
    let bytes: Vec<u8> = floats.chain(moved).flat_map(f32::to_le_bytes).collect();
    let hex = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, &bytes);
    json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{hex}")}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 8},
            {"buffer": 0, "byteOffset": 80, "byteLength": 24}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
        "meshes": [{"name": "flag", "primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{}, {"mesh": 0}, {"mesh": 0, "name": "moved"}],
        "animations": [
            {"name": "wave", "channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}],
             "samplers": [{"input": 1, "output": 2}]},
            {"name": "still", "channels": [], "samplers": []}],
    })
    .to_string()
}

fn check(folder: &Path, args: &[&str]) -> Run {
    sscc(folder, &[&["check"], args].concat())
}

/// Runs with `--json`; asserts the keys, and returns the lines.
fn lines(folder: &Path, args: &[&str], more_keys: &str) -> Vec<Value> {
    let run = check(folder, &[args, &["--json"]].concat());
    assert_eq!(run.stderr, "", "{run:?}");
    let lines = run.json();
    let collides = lines.iter().any(|line| line["colliding"] == true);
    assert_eq!(run.code, Some(i32::from(collides)));
    for line in &lines {
        assert_eq!(keys(line), sorted(&format!("{KEYS},{more_keys}")));
        assert_eq!(line["count"], json!(line["pairs"].as_array().unwrap().len()));
        assert!(line["norm"].is_null() && line["root_certified"].is_null());
    }
    lines
}

fn counts(lines: &[Value]) -> Vec<u64> {
    lines.iter().map(|line| line["count"].as_u64().unwrap()).collect()
}

#[test]
fn meshes_at_rest() {
    let directory = folder();
    let folder = directory.path();
    fs::write(folder.join("touching.obj"), obj(0.0)).unwrap();
    assert_eq!(counts(&lines(folder, &["mesh.obj"], "")), [0]);
    assert_eq!(lines(folder, &["touching.obj"], "")[0]["pairs"], json!([[0, 1]]));
    assert_eq!(counts(&lines(folder, &["flag.gltf"], "")), [0]);
    assert_eq!(counts(&lines(folder, &["flag.gltf", "--mesh-name", "#0", "--weld=off"], "")), [1]);
    let text = check(folder, &["touching.obj"]);
    assert!(text.stdout.starts_with("COLLIDING: 1 pair of triangles\n"), "{text:?}");
    assert!(
        check(folder, &["mesh.obj"])
            .stdout
            .starts_with("free: proven, apart from pairs with common vertices\n")
    );

    let all = ["mesh.obj", "touching.obj", "flag.gltf", "frames/10.obj"];
    for threads in ["1", "2", "7"] {
        let all_lines = lines(folder, &[&all[..], &["--threads", threads]].concat(), "file");
        assert_eq!(counts(&all_lines), [0, 1, 0, 1]);
        let files: Vec<&str> = all_lines.iter().map(|line| line["file"].as_str().unwrap()).collect();
        assert_eq!(files, all);
    }
    let text = check(folder, &all);
    assert!(text.stdout.lines().nth(1).unwrap().starts_with("touching.obj "), "{text:?}");
    assert!(
        text.stdout.lines().last().unwrap().starts_with("4 files: 2 free, 2 colliding; median "),
        "{text:?}"
    );

    let pose = check(folder, &["touching.obj", "--pose", "pose.obj"]);
    assert_eq!(pose.code, Some(1), "{pose:?}");
    assert!(fs::read_to_string(folder.join("pose.obj")).unwrap().contains("g colliding\n"));
}

#[test]
fn frames_from_arrays_and_folders() {
    let directory = folder();
    let folder = directory.path();
    // The same frames in float32.
    let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 6, 3), }\n";
    let mut single = [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes()].concat();
    single.extend(frames(&[1.0, 0.5, 0.0, -0.5]).iter().flat_map(|x| (*x as f32).to_le_bytes()));
    fs::write(folder.join("single.npy"), single).unwrap();
    for source in ["frames.npy", "frames", "single.npy"] {
        let args = ["mesh.obj", "--frames", source];
        assert_eq!(counts(&lines(folder, &args, "")), [0, 0, 1, 0], "{source}");
        let continuous = lines(folder, &[&args[..], &["--continuous"]].concat(), "times");
        assert_eq!(counts(&continuous), [0, 1, 1], "{source}");
        assert_eq!(continuous.iter().map(|line| line["index"].clone()).collect::<Vec<_>>(), [0, 1, 2]);
        assert!((continuous[1]["times"][0].as_f64().unwrap() - 1.0).abs() < 1e-9);
        for limit in [&["--first"][..], &["--limit", "1", "--threads", "3"]] {
            assert_eq!(counts(&lines(folder, &[&args[..], limit].concat(), "")), [0, 0, 1, 0]);
        }
    }
    let text = check(folder, &["mesh.obj", "--frames", "frames"]);
    let printed: Vec<&str> = text.stdout.lines().collect();
    assert!(printed[2].ends_with("COLLIDING  1 pair, first 0 1"), "{text:?}");
    assert!(printed[4].starts_with("4 frames: 3 free, 1 colliding; median "), "{text:?}");
    // Only the faces of the mesh at rest are used. If the pairs that collide at rest are ignored, no pair remains.
    fs::write(folder.join("touching.obj"), obj(0.0)).unwrap();
    let ignored =
        lines(folder, &["touching.obj", "--frames", "frames", "--ignore-rest"], "ignored, left_out");
    assert_eq!(counts(&ignored), [0; 4]);
    assert!(ignored.iter().all(|line| line["ignored"] == json!(1)));
    assert_eq!(ignored[0]["left_out"], json!("1 ignored pair and pairs with common vertices"));
}

/// Two triangles of an STL file have a common corner at rest: they are adjacent only if it is common in all frames.
#[test]
fn vertices_that_stay_together_are_welded() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let facet = |corners: [&str; 3]| {
        format!("facet normal 0 0 0\nouter loop\nvertex {}\nendloop\nendfacet\n", corners.join("\nvertex "))
    };
    let facets = facet(["0 0 0", "1 0 0", "0 1 0"]) + &facet(["0 0 0", "0 -1 0", "-1 0 0"]);
    fs::write(folder.join("two.stl"), format!("solid two\n{facets}endsolid two\n")).unwrap();
    let still = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].concat();
    let together = [[0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]].concat();
    // The second triangle goes through the first.
    let apart = [[0.2, 0.2, -1.0], [0.2, 0.3, 1.0], [0.3, 0.2, 1.0]].concat();
    let frames = [&still[..], &together, &still, &apart].concat();
    write_npy(&folder.join("apart.npy"), &[2, 6, 3], &frames).unwrap();
    write_npy(&folder.join("together.npy"), &[1, 6, 3], &frames[..18]).unwrap();
    let run = |frames: &str, weld: &[&str]| {
        let frames = format!("--frames={frames}");
        counts(&lines(folder, &[&["two.stl", &frames][..], weld].concat(), ""))
    };
    assert_eq!(run("together.npy", &[]), [0]);
    assert_eq!(run("together.npy", &["--weld=off"]), [1]);
    assert_eq!(run("apart.npy", &[]), [1, 1]);
    assert_eq!(run("apart.npy", &["--weld=off"]), [1, 1]);
}

#[test]
fn animations() {
    let directory = folder();
    let folder = directory.path();
    let of = |args: &[&str], more: &str| lines(folder, &[&["flag.gltf", "--animation"], args].concat(), more);
    let list = of(&["wave", "--fps", "2"], "node,time");
    let places: Vec<_> = list.iter().map(|line| (line["node"].clone(), line["time"].clone())).collect();
    let expected = [1, 2].iter().flat_map(|node| [0.0, 0.5, 1.0].map(|time| (json!(node), json!(time))));
    assert_eq!(places, expected.collect::<Vec<_>>());
    assert_eq!(counts(&list), [0; 6]);
    assert_eq!(of(&["0"], "node,time").len(), 2 * 31);
    assert_eq!(counts(&of(&["0", "--node", "2", "--times=0.25,-1", "--weld=off"], "node,time")), [1, 1]);
    let steps = of(&["0", "--node", "2", "--continuous", "--weld=off", "--fps=1"], "node,time,times");
    assert_eq!((counts(&steps), &steps[0]["time"]), (vec![1], &json!(0.0)));
    let several = lines(folder, &["flag.gltf", "flag.gltf", "--animation=0", "--times=0"], "file,node,time");
    assert_eq!(several.len(), 4);
    let text = check(folder, &["flag.gltf", "--animation", "wave", "--times=0.5"]);
    assert!(text.stdout.starts_with("node 1    frame     0  0.5000 s "), "{text:?}");
}

#[test]
fn two_meshes() {
    let directory = folder();
    let folder = directory.path();
    write_npy(&folder.join("up.npy"), &[4, 3, 3], &[0.0, 0.0, 3.0, 1.0, 0.0, 3.0, 0.0, 1.0, 3.0].repeat(4))
        .unwrap();
    let found = lines(folder, &["mesh.obj", "--against", "lower.obj"], "");
    assert_eq!(found[0]["pairs"], json!([[0, 0], [1, 0]]));
    let first = lines(folder, &["mesh.obj", "--against", "lower.obj", "--first"], "");
    assert_eq!((counts(&first), &first[0]["complete"]), (vec![1], &json!(false)));
    let turned = lines(folder, &["lower.obj", "--against", "mesh.obj"], "");
    assert_eq!(turned[0]["pairs"], json!([[0, 0], [0, 1]]));
    let moving = lines(folder, &["mesh.obj", "--frames", "frames", "--against", "lower.obj"], "");
    assert_eq!(counts(&moving), [2; 4]);
    let both = ["mesh.obj", "--frames", "frames.npy", "--against", "lower.obj", "--against-frames", "up.npy"];
    assert_eq!(counts(&lines(folder, &both, "")), [0; 4]);
    let alone = ["mesh.obj", "--against", "lower.obj", "--against-frames", "up.npy", "--continuous"];
    assert_eq!(counts(&lines(folder, &alone, "times")), [0; 3]);
}

/// Groups leave out pairs at rest, in frames, in animations and between frames.
#[test]
fn groups_of_meshes() {
    let directory = folder();
    let folder = directory.path();
    fs::write(
        folder.join("grouped.obj"),
        obj(0.0).replace("f 1", "g low\nf 1").replace("f 4", "g high\nf 4"),
    )
    .unwrap();
    write_npy(&folder.join("numbers.npy"), &[2], &[0.0, 7.0]).unwrap();
    let none = &["--ignore-groups=low,high"][..];
    let all = &["--only-groups=high,low"][..];
    let (by_number, within) =
        (&["--ignore-groups=7,0", "--group-by=numbers.npy"][..], &["--ignore-groups=low,low"][..]);
    for (groups, count) in [(none, 0), (all, 1), (by_number, 0), (within, 1)] {
        let run = |args: &[&str], more: &str| counts(&lines(folder, &[args, groups].concat(), more));
        assert_eq!(run(&["grouped.obj"], ""), [count], "{groups:?}");
        assert_eq!(run(&["grouped.obj", "grouped.obj"], "file"), [count; 2], "{groups:?}");
        assert_eq!(run(&["grouped.obj", "--frames=frames"], ""), [0, 0, count, 0], "{groups:?}");
        let continuous = run(&["grouped.obj", "--frames=frames.npy", "--continuous"], "times");
        assert_eq!(continuous, [0, count, count], "{groups:?}");
    }

    // One primitive at two nodes, of which one has a name.
    let primitive = ["flag.gltf", "--weld=off", "--ignore-groups=#0,#0"];
    assert_eq!(counts(&lines(folder, &primitive, "")), [0]);
    let animated = |args: &[&str]| {
        let flags = ["flag.gltf", "--weld=off", "--animation=0", "--times=0.5"];
        counts(&lines(folder, &[&flags, args].concat(), "node,time"))
    };
    assert_eq!(animated(&[]), [1, 1]);
    assert_eq!(animated(&["--ignore-groups=#0,#0"]), [0, 0]);
    assert_eq!(animated(&["--ignore-groups=moved,moved", "--group-by=object"]), [1, 0]);
    assert_eq!(animated(&["--only-groups=moved,moved", "--group-by=object"]), [0, 1]);
    assert_eq!(animated(&["--only-groups=0,0", "--group-by=numbers.npy"]), [0, 0]);
}

/// A triangle in the plane z = 0, and one of which a corner is 0.25 below it.
const CROSSING: &str = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -0.25\nv 1 1 2\nv 2 1 2\nf 1 2 3\nf 4 5 6\n";

#[test]
fn depths_of_pairs() {
    let directory = folder();
    let folder = directory.path();
    fs::write(folder.join("crossing.obj"), CROSSING).unwrap();
    fs::write(folder.join("touching.obj"), obj(0.0)).unwrap();
    let all = ["crossing.obj", "touching.obj", "mesh.obj", "--depths"];
    let found = lines(folder, &all, "file,depths,directions");
    assert_eq!(found[0]["depths"], json!([0.25]));
    assert_eq!(found[0]["directions"], json!([[0.0, 0.0, 1.0]]));
    assert_eq!((&found[1]["depths"], &found[2]["depths"]), (&json!([0.0]), &json!([])));
    let frames = lines(folder, &["mesh.obj", "--frames=frames", "--depths"], "depths,directions");
    assert_eq!(frames[2]["depths"], json!([0.0]));
    let against = lines(folder, &["mesh.obj", "--against=lower.obj", "--depths"], "depths,directions");
    assert_eq!(against[0]["depths"].as_array().unwrap().len(), 2);
    assert_eq!(against[0]["depths"][1], json!(0.0));
    assert!(against[0]["depths"][0].as_f64().unwrap() > 0.3, "{against:?}");
    let text = check(folder, &["crossing.obj", "--depths"]);
    assert!(text.stdout.ends_with("       0        1  depth 0.2500\n"), "{text:?}");
    let text = check(folder, &["crossing.obj", "mesh.obj", "--depths"]);
    assert!(text.stdout.contains("COLLIDING  1 pair, first 0 1, deepest 0.2500\n"), "{text:?}");
}

/// Comments and points of a file of curves.
fn curves(path: &Path) -> (Vec<String>, Vec<[f64; 3]>) {
    let text = fs::read_to_string(path).unwrap();
    let comments = text.lines().filter_map(|line| line.strip_prefix("# ")).map(str::to_owned).collect();
    let point = |line: &str| -> [f64; 3] {
        let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        numbers.try_into().unwrap()
    };
    (comments, text.lines().filter_map(|line| line.strip_prefix("v ")).map(point).collect())
}

#[test]
fn curves_of_the_last_answer() {
    let directory = folder();
    let folder = directory.path();
    fs::write(folder.join("crossing.obj"), CROSSING).unwrap();
    let run = |args: &[&str], code: i32| {
        let run = check(folder, &[args, &["--curves=c.obj"]].concat());
        assert_eq!((run.code, run.stderr.as_str()), (Some(code), ""), "{run:?}");
        let found = curves(&folder.join("c.obj"));
        fs::remove_file(folder.join("c.obj")).unwrap();
        found
    };
    let (comments, points) = run(&["crossing.obj"], 1);
    assert_eq!(comments[1], "curve 0: open, 1 segment, deepest pair 0 1 (0.25)");
    let mut x: Vec<f64> = points.iter().map(|p| p[0]).collect();
    x.sort_by(f64::total_cmp);
    assert_eq!(x, [1.0, 1.0 + 1.0 / 9.0]);
    assert!(points.iter().all(|p| p[1..] == [1.0, 0.0]));
    // One triangle crosses, a corner of it touches the other.
    let (comments, points) = run(&["mesh.obj", "--against=lower.obj"], 1);
    assert_eq!(
        comments[0],
        "contact curves: 1; not among them: 1 pair with one common point, 0 pairs in one plane"
    );
    assert_eq!(points.len(), 2);
    // The last file, frame and node.
    assert_eq!(run(&["mesh.obj", "crossing.obj"], 1).1.len(), 2);
    assert_eq!(run(&["crossing.obj", "mesh.obj", "--threads=3"], 1).1.len(), 0);
    let mesh = sscc_io::read_mesh(&folder.join("crossing.obj")).unwrap();
    let positions: Vec<f64> = mesh.rest_positions().iter().flat_map(|p| p.to_array()).collect();
    let apart = positions.iter().enumerate().map(|(i, x)| if i >= 9 && i % 3 == 2 { x + 9.0 } else { *x });
    let both: Vec<f64> = apart.chain(positions.iter().copied()).collect();
    write_npy(&folder.join("last.npy"), &[2, 6, 3], &both).unwrap();
    for threads in ["--threads=1", "--threads=2"] {
        assert_eq!(run(&["mesh.obj", "--frames=last.npy", threads], 1).1, run(&["crossing.obj"], 1).1);
    }
    let (comments, _) = run(&["flag.gltf", "--weld=off", "--animation=0", "--times=0"], 1);
    assert!(comments[0].starts_with("contact curves: 1;"), "{comments:?}");
    // PLY: the points are read back.
    assert_eq!(check(folder, &["crossing.obj", "--curves=c.ply"]).code, Some(1));
    let header = String::from_utf8_lossy(&fs::read(folder.join("c.ply")).unwrap()).into_owned();
    assert!(header.contains("element vertex 2\n") && header.contains("element edge 1\n"), "{header}");
}

/// The file of curves is written even if no one reads the answers.
#[test]
fn curves_are_written_without_a_reader_of_the_output() {
    let directory = folder();
    let folder = directory.path();
    fs::write(folder.join("crossing.obj"), CROSSING).unwrap();
    let many: Vec<&str> = [&["mesh.obj"; 200][..], &["crossing.obj"]].concat();
    let args = [&["check", "--json", "--curves=c.obj"], &many[..]].concat();
    let mut child =
        crate::common::command(folder, &args).stdout(std::process::Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
    assert_eq!(curves(&folder.join("c.obj")).1.len(), 2);
}
