//! Nodes place meshes of glTF files, and each side of a comparison has a name.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use sscc_io::read_mesh;

use crate::common::{keys, sscc};

/// Triangles without indices, three corners each.
pub type Corners = Vec<[f32; 3]>;

/// A glTF file of meshes with these names and corners, of float32, and these nodes.
pub fn gltf(meshes: &[(&str, &[[f32; 3]])], nodes: Value) -> Value {
    let bytes = |corners: &[[f32; 3]]| {
        corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()
    };
    let buffer = |(_, corners): &(&str, &[[f32; 3]])| {
        let bytes = bytes(corners);
        json!({"byteLength": bytes.len(), "uri": format!("data:;base64,{}", BASE64.encode(bytes))})
    };
    let view = |(number, (_, corners)): (usize, &(&str, &[[f32; 3]]))| json!({"buffer": number, "byteLength": 12 * corners.len()});
    let accessor = |(number, (_, corners)): (usize, &(&str, &[[f32; 3]]))| json!({"bufferView": number, "componentType": 5126, "count": corners.len(), "type": "VEC3"});
    let mesh = |(number, (name, _)): (usize, &(&str, &[[f32; 3]]))| json!({"name": name, "primitives": [{"attributes": {"POSITION": number}}]});
    json!({
        "asset": {"version": "2.0"},
        "buffers": meshes.iter().map(buffer).collect::<Vec<_>>(),
        "bufferViews": meshes.iter().enumerate().map(view).collect::<Vec<_>>(),
        "accessors": meshes.iter().enumerate().map(accessor).collect::<Vec<_>>(),
        "meshes": meshes.iter().enumerate().map(mesh).collect::<Vec<_>>(),
        "nodes": nodes,
    })
}

/// A large triangle in the plane z = 0.
const SHEET: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

/// A triangle that pierces it.
const NEEDLE: [[f32; 3]; 3] = [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]];

fn write(folder: &Path, name: &str, file: &Value) {
    fs::write(folder.join(name), file.to_string()).unwrap();
}

/// Runs `check` with `--json`, and returns its lines. Standard error must be empty.
fn lines(folder: &Path, args: &[&str]) -> Vec<Value> {
    let run = sscc(folder, &[&["check"], args, &["--json"]].concat());
    assert_eq!(run.stderr, "", "{run:?}");
    let lines = run.json();
    let collides = lines.iter().any(|line| line["colliding"] == true);
    assert_eq!(run.code, Some(i32::from(collides)), "{run:?}");
    lines
}

fn pairs(folder: &Path, args: &[&str]) -> Vec<Value> {
    lines(folder, args).iter().map(|line| line["pairs"].clone()).collect()
}

#[test]
fn nodes_place_both_meshes() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let needle = |nodes: Value| gltf(&[("needle", &NEEDLE)], nodes);
    // The needle stored 100 away, and in hundredths.
    let moved = NEEDLE.map(|[x, y, z]| [x + 100.0, y, z]);
    let hundredths = NEEDLE.map(|x| x.map(|x| 100.0 * x));
    write(folder, "sheet.gltf", &gltf(&[("sheet", &SHEET)], json!([{"mesh": 0}])));
    let back = json!({"mesh": 0, "translation": [-100, 0, 0]});
    for (name, file, expected) in [
        ("here.gltf", needle(json!([{"mesh": 0}])), json!([[0, 0]])),
        ("far.gltf", needle(json!([{"mesh": 0, "translation": [100, 0, 0]}])), json!([])),
        ("back.gltf", gltf(&[("needle", &moved)], json!([back])), json!([[0, 0]])),
        ("stored.gltf", gltf(&[("needle", &moved)], json!([{"mesh": 0}])), json!([])),
        (
            "small.gltf",
            gltf(&[("needle", &hundredths)], json!([{"mesh": 0, "scale": [0.01, 0.01, 0.01]}])),
            json!([[0, 0]]),
        ),
        // A mirrored child of a turned node: it pierces the sheet from below, at its corner.
        (
            "mirrored.gltf",
            needle(json!([
                {"children": [1], "rotation": [0, 0, 1, 0], "translation": [3, 3, 0]},
                {"mesh": 0, "scale": [1, 1, -2], "translation": [0.5, 0, 0.5]}])),
            json!([[0, 0]]),
        ),
        (
            "matrix.gltf",
            needle(json!([{"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,-1.5,1]}])),
            json!([]),
        ),
        // No node shows it: it stays where it is stored, with a warning.
        ("nowhere.gltf", needle(json!([{}])), json!([[0, 0]])),
    ] {
        write(folder, name, &file);
        for args in [[name, "--against", "sheet.gltf"], ["sheet.gltf", "--against", name]] {
            let run = sscc(folder, &[&["check"], &args[..], &["--json"]].concat());
            let warning = if name == "nowhere.gltf" {
                "warning: nowhere.gltf: no node shows the mesh: it is checked in its own coordinates\n"
            } else {
                ""
            };
            assert_eq!(run.stderr, warning, "{run:?}");
            assert_eq!((&run.json()[0]["pairs"], run.json().len()), (&expected, 1), "{name}");
            assert!(run.json()[0].get("node").is_none());
        }
    }
    // Beside a mesh without nodes, and while it moves.
    fs::write(folder.join("sheet.obj"), "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n").unwrap();
    assert_eq!(pairs(folder, &["back.gltf", "--against=sheet.obj"]), [json!([[0, 0]])]);
    assert_eq!(pairs(folder, &["sheet.obj", "--against=far.gltf"]), [json!([])]);
    let frames: Vec<f64> = [100.0, 0.0]
        .iter()
        .flat_map(|x| SHEET.iter().flat_map(move |p| [f64::from(p[0]) + x, f64::from(p[1]), 0.0]))
        .collect();
    sscc_io::write_npy(&folder.join("frames.npy"), &[2, 3, 3], &frames).unwrap();
    let moving = ["sheet.obj", "--frames=frames.npy", "--against=far.gltf"];
    assert_eq!(pairs(folder, &moving), [json!([[0, 0]]), json!([])]);
}

#[test]
fn poses_and_reports_are_placed() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let corners = [&SHEET[..], &NEEDLE].concat();
    let nodes = json!([{"mesh": 0, "scale": [0.1, 0.5, 2], "translation": [0.7, -10, 1e3]}]);
    write(folder, "both.gltf", &gltf(&[("both", &corners)], nodes));
    let run = sscc(folder, &["check", "both.gltf", "--pose=pose.obj", "--report=r.html", "--json"]);
    assert_eq!((run.code, &run.json()[0]["pairs"]), (Some(1), &json!([[0, 1]])), "{run:?}");
    let expected: Vec<[f64; 3]> = corners
        .iter()
        .map(|corner| {
            let [x, y, z] = corner.map(f64::from);
            [0.1 * x + 0.7, 0.5 * y - 10.0, 2.0 * z + 1e3]
        })
        .collect();
    let written = read_mesh(&folder.join("pose.obj")).unwrap();
    let positions: Vec<[f64; 3]> = written.rest_positions().iter().map(|x| x.to_array()).collect();
    assert_eq!(positions, expected);
    let html = fs::read_to_string(folder.join("r.html")).unwrap();
    let (_, data) = html.split_once("id=\"sscc-report\">").unwrap();
    let data: Value = serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap();
    // The middle of the AABB of all positions.
    let center = data["scene"]["playback"]["bodies"][0]["center"].as_array().unwrap();
    let center: Vec<f64> = center.iter().map(|x| x.as_f64().unwrap()).collect();
    assert!((center[0] - 0.9).abs() < 1e-12 && (center[1] + 9.0).abs() < 1e-12, "{center:?}");
    assert_eq!(center[2], 1e3);
}

/// A mesh at several nodes is compared at each of them.
#[test]
fn every_node_is_compared() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let two =
        json!([{}, {"mesh": 0, "name": "left", "translation": [100, 0, 0]}, {"mesh": 0, "name": "right"}]);
    write(folder, "needles.gltf", &gltf(&[("needle", &NEEDLE)], two.clone()));
    write(folder, "sheets.gltf", &gltf(&[("sheet", &SHEET)], two));
    fs::write(folder.join("sheet.obj"), "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n").unwrap();
    let places = |args: &[&str]| -> Vec<(Value, Value, Value)> {
        let place =
            |line: &Value| (line["node"].clone(), line["against_node"].clone(), line["count"].clone());
        lines(folder, args).iter().map(place).collect()
    };
    let found = places(&["needles.gltf", "--against", "sheet.obj"]);
    assert_eq!(found, [(json!(1), Value::Null, json!(0)), (json!(2), Value::Null, json!(1))]);
    let found = places(&["sheet.obj", "--against", "needles.gltf"]);
    assert_eq!(found, [(Value::Null, json!(1), json!(0)), (Value::Null, json!(2), json!(1))]);
    let found = places(&["needles.gltf", "--against", "sheets.gltf"]);
    let expected = [(1, 1, 1), (1, 2, 0), (2, 1, 0), (2, 2, 1)];
    assert_eq!(found, expected.map(|(a, b, count)| (json!(a), json!(b), json!(count))));
    let text = sscc(folder, &["check", "needles.gltf", "--against", "sheets.gltf"]);
    assert!(text.stdout.starts_with("node 1    against node 1 "), "{text:?}");
    assert!(text.stdout.contains("4 comparisons: 2 free, 2 colliding; median "), "{text:?}");
    assert!(text.stdout.contains("; worst: node 1 against node 1 (1 pair)"), "{text:?}");
    let text = sscc(folder, &["check", "sheet.obj", "--against", "needles.gltf"]);
    assert!(text.stdout.contains("; worst: against node 2 (1 pair)"), "{text:?}");
    // A node has a name of its own.
    let found = places(&["needles.gltf#left", "--against", "sheets.gltf#right"]);
    assert_eq!(found, [(Value::Null, Value::Null, json!(0))]);
    let left =
        places(&["needles.gltf", "--mesh-name=left", "--against", "sheets.gltf", "--against-mesh=left"]);
    assert_eq!(left, [(Value::Null, Value::Null, json!(1))]);
    // Without another mesh, the first place represents all: an affine map changes no collision of a mesh.
    let flat = json!([{"mesh": 0, "scale": [0, 1, 1]}, {"mesh": 0}]);
    write(folder, "flat.gltf", &gltf(&[("needle", &NEEDLE)], flat));
    let run = sscc(folder, &["check", "flat.gltf"]);
    let other =
        "node 0 alone is checked; node 1 shows the mesh with another skin, or one of them flattens it";
    assert!(run.stderr.contains(other), "{run:?}");
    // The other mesh is made for each comparison, but its warning is one.
    let run = sscc(folder, &["check", "sheets.gltf", "--against", "flat.gltf"]);
    assert_eq!(run.stderr.matches("flat.gltf: node 0: a scale of 0 flattens the mesh").count(), 1, "{run:?}");
    let alone = lines(folder, &["needles.gltf"]);
    assert_eq!((alone.len(), alone[0].get("node")), (1, None));
    let many: Vec<Value> = (0..101).map(|_| json!({"mesh": 0})).collect();
    write(folder, "many.gltf", &gltf(&[("sheet", &SHEET)], json!(many)));
    write(folder, "others.gltf", &gltf(&[("sheet", &SHEET)], json!(many)));
    let too_many = sscc(folder, &["check", "many.gltf", "--against=others.gltf"]);
    assert!(too_many.refusal().contains("101 nodes show the mesh, and 101 the other one"), "{too_many:?}");
    let report = sscc(folder, &["check", "needles.gltf", "--against=sheet.obj", "--report=r.html"]);
    assert!(
        report.refusal().ends_with("a report shows one of each: name the nodes, as in FILE#NODE"),
        "{report:?}"
    );
    let report = sscc(folder, &["check", "needles.gltf#right", "--against=sheet.obj", "--report=r.html"]);
    assert_eq!((report.code, folder.join("r.html").exists()), (Some(1), true), "{report:?}");
}

#[test]
fn each_side_has_a_name() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let nodes = json!([{"mesh": 0}, {"mesh": 1}]);
    write(folder, "two.gltf", &gltf(&[("Body", &SHEET), ("Shirt", &NEEDLE)], nodes.clone()));
    write(folder, "other.gltf", &gltf(&[("Hat", &NEEDLE), ("Shirt", &NEEDLE)], nodes));
    fs::write(folder.join("sheet.obj"), "v 0 0 0\nv 4 0 0\nv 0 4 0\nf 1 2 3\n").unwrap();
    for args in [
        &["two.gltf", "--mesh-name=Body", "--against=two.gltf", "--against-mesh=Shirt"][..],
        &["two.gltf#Body", "--against=two.gltf#Shirt"],
        &["two.gltf#Shirt", "--against=two.gltf", "--against-mesh=Body"],
        &["two.gltf##0", "--against=./two.gltf#1"],
        &["two.gltf", "--mesh-name=#0", "--against", "two.gltf##1"],
        &["two.gltf#Body", "--against=other.gltf#Hat"],
        &["other.gltf#Shirt", "--against=two.gltf#Body"],
    ] {
        assert_eq!(pairs(folder, args), [json!([[0, 0]])], "{args:?}");
    }
    let several = lines(folder, &["two.gltf#Body", "two.gltf#Shirt", "other.gltf#Hat"]);
    assert_eq!(several.iter().map(|line| &line["file"]).collect::<Vec<_>>().len(), 3);
    assert_eq!(several[1]["file"], "two.gltf#Shirt");
    let refused = |args: &[&str], cause: &str| {
        let run = sscc(folder, &[&["check"], args].concat());
        assert_eq!((run.code, run.stdout.as_str(), run.stderr.lines().count()), (Some(2), "", 1), "{run:?}");
        assert!(run.stderr.contains(cause), "{run:?}");
    };
    // A name belongs to its side alone, so nothing is compared with itself silently.
    let choose = "2 meshes have triangles: choose one with --mesh-name or --against-mesh, or as FILE#NAME: 'Body', \
                  'Shirt'";
    refused(&["two.gltf", "--mesh-name=Body", "--against=two.gltf"], choose);
    refused(&["two.gltf", "--against=two.gltf#Body"], choose);
    let same = "two.gltf: the same mesh is on both sides: name a mesh for each, as in two.gltf#A --against two.gltf#B, or \
                with --mesh-name and --against-mesh";
    refused(&["two.gltf#Body", "--against", "two.gltf", "--against-mesh=Body"], same);
    refused(&["two.gltf#Body", "--against", "two.gltf", "--against-mesh=#0"], same);
    let alone = "sheet.obj: the same mesh is on both sides: give another one; its collisions with itself are found without";
    refused(&["sheet.obj", "--against=sheet.obj"], alone);
    refused(&["sheet.obj", "--against=./sheet.obj"], alone);
    refused(
        &["sheet.obj", "--mesh-name=a", "--against=two.gltf#Body"],
        "only a glTF file can have several meshes",
    );
    refused(&["sheet.obj#a", "--against=two.gltf#Body"], "only a glTF file can have several meshes");
    refused(&["two.gltf#Body", "--mesh-name=Shirt"], "the mesh is named twice, here and by the name 'Shirt'");
    refused(&["two.gltf#Body", "--against-mesh=Shirt"], "--against");
    refused(&["two.gltf#Coat"], "there is no mesh 'Coat'; meshes with triangles: 'Body', 'Shirt'");
    refused(&["two.gltf#Body", "--animation=0"], "leave out the name after #; --node selects a node");
    // The same mesh in two motions is at two places.
    let frames = |shift: f64| -> Vec<f64> {
        SHEET.iter().flat_map(|p| [f64::from(p[0]), f64::from(p[1]), f64::from(p[2]) + shift]).collect()
    };
    for (name, shift) in [("low.npy", 0.0), ("high.npy", 1.0)] {
        sscc_io::write_npy(&folder.join(name), &[1, 3, 3], &frames(shift)).unwrap();
    }
    let against = |frames: [&str; 2]| {
        let [mesh, other] = [format!("--frames={}", frames[0]), format!("--against-frames={}", frames[1])];
        sscc(folder, &["check", "sheet.obj", &mesh, "--against=sheet.obj", &other, "--json"])
    };
    assert_eq!(against(["low.npy", "high.npy"]).code, Some(0));
    assert!(against(["low.npy", "low.npy"]).stderr.contains("the same mesh is on both sides"));
    // Frames are at no node.
    let nodes = json!([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [0, 0, 9]}]);
    write(folder, "twice.gltf", &gltf(&[("sheet", &SHEET)], nodes));
    let frames = ["--frames=low.npy", "--against-frames=low.npy"];
    refused(
        &[&["twice.gltf#a", "--against=twice.gltf#b"], &frames[..]].concat(),
        "the same mesh is on both sides",
    );
    let moving = lines(folder, &["twice.gltf", "--frames=low.npy", "--against=two.gltf#Shirt"]);
    assert_eq!((moving.len(), moving[0].get("node"), &moving[0]["count"]), (1, None, &json!(1)));
}

/// A sheet, and a needle above it; the first primitive has no morph target, the second one's lowers the needle.
fn unequal() -> Value {
    let above = NEEDLE.map(|[x, y, z]| [x, y, z + 2.0]);
    let down = [[0.0, 0.0, -2.0]; 3];
    let nodes = json!([{"mesh": 0, "scale": [2, 2, 2], "translation": [0, 0, 7]}]);
    let mut file = gltf(&[("a", &SHEET), ("b", &above), ("c", &down)], nodes);
    file["meshes"] = json!([{"primitives": [
        {"attributes": {"POSITION": 0}},
        {"attributes": {"POSITION": 1}, "targets": [{"POSITION": 2}]}],
        "extras": {"targetNames": ["down"]}}]);
    file
}

#[test]
fn missing_morph_targets_move_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    write(folder, "m.vrm", &unequal());
    // At rest no targets are needed.
    assert_eq!(pairs(folder, &["m.vrm"]), [json!([])]);
    let warning = "warning: m.vrm: meshes[0]: its primitives have 0 to 1 morph targets; the missing ones move nothing\n";
    let run =
        sscc(folder, &["check", "m.vrm", "--q=down=1", "--method=traditional", "--json", "--pose=p.obj"]);
    assert_eq!((run.stderr.as_str(), run.code), (warning, Some(1)), "{run:?}");
    assert_eq!(run.json()[0]["pairs"], json!([[0, 1]]));
    // The pose of a model is where the node puts it.
    let pose = read_mesh(&folder.join("p.obj")).unwrap();
    let expected: Vec<[f64; 3]> = [SHEET, NEEDLE]
        .concat()
        .iter()
        .map(|corner| [0, 1, 2].map(|k| 2.0 * f64::from(corner[k]) + [0.0, 0.0, 7.0][k]))
        .collect();
    assert_eq!(pose.rest_positions().iter().map(|x| x.to_array()).collect::<Vec<_>>(), expected);
    // Poses of sweeps and contact curves are at this place, too.
    let sweep = sscc(folder, &["sweep", "m.vrm", "--range=0,1", "--pose=poses", "--json"]);
    assert_eq!(sweep.code, Some(1), "{sweep:?}");
    let hit = read_mesh(&folder.join("poses/000_down_up.ply")).unwrap();
    assert_eq!(hit.rest_positions()[1].to_array(), expected[1]);
    let curves = sscc(folder, &["check", "m.vrm", "--q=1", "--method=traditional", "--curves=c.obj"]);
    assert_eq!(curves.code, Some(1), "{curves:?}");
    let curves = fs::read_to_string(folder.join("c.obj")).unwrap();
    let points: Vec<&str> = curves.lines().filter(|line| line.starts_with("v ")).collect();
    assert!(points.len() == 2 && points.iter().all(|point| point.ends_with(" 7.0")), "{curves}");
    let certify = sscc(folder, &["certify", "m.vrm", "-o", "m.sscc.safetensors", "--json"]);
    assert_eq!((certify.code, keys(&certify.json()[0]).contains(&"rank")), (Some(0), true), "{certify:?}");
    let info = sscc(folder, &["info", "m.vrm", "--json"]).json().remove(0);
    assert_eq!((&info["kind"], &info["meshes"][0]["targets"]), (&json!("gltf"), &json!(["down"])));
    let modes = sscc(folder, &["check", "m.vrm", "--modes=x.npy", "--q=1"]);
    assert!(modes.refusal().ends_with("a model file has its own modes: leave out --modes"), "{modes:?}");
}

/// A malformed animation does not refuse the others, and mesh data that a check does not need do not refuse the file.
#[test]
fn content_that_a_check_does_not_need_refuses_no_file() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let mut file = gltf(&[("sheet", &SHEET), ("times", &[[0.0, 1.0, 2.0]])], json!([{"mesh": 0}]));
    file["accessors"][1] = json!({"bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR"});
    file["meshes"].as_array_mut().unwrap().truncate(1);
    file["animations"] = json!([
        {"name": "bad", "channels": [{"sampler": 0, "target": {"node": 7, "path": "scale"}}],
         "samplers": [{"input": 1, "output": 0}]},
        {"name": "good", "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
         "samplers": [{"input": 1, "output": 0}]}]);
    write(folder, "a.gltf", &file);
    let good = lines(folder, &["a.gltf", "--animation=good", "--times=0,2"]);
    assert_eq!(good.len(), 2);
    let bad = sscc(folder, &["check", "a.gltf", "--animation=bad", "--times=0"]);
    assert!(bad.refusal().ends_with("a.gltf: animations[0].channels[0]: nodes[7] does not exist"), "{bad:?}");
    // At rest, animations are not even parsed.
    file["animations"] = json!("none");
    file["skins"] = json!([{"joints": []}]);
    file["cameras"] = json!(7);
    write(folder, "a.gltf", &file);
    assert_eq!(pairs(folder, &["a.gltf"]), [json!([])]);
}

/// Coincident triangles of different joints move apart, so their vertices are not welded.
#[test]
fn skins_separate_vertices_at_rest_as_in_animations() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let layers = [SHEET, SHEET].concat();
    let skinned = |second: u8, node: Value| {
        let mut file = gltf(&[("layers", &layers), ("zero", &[[0.0; 3]])], json!([node, {}, {}]));
        let joints: Vec<u8> =
            [0, 0, 0, second, second, second].iter().flat_map(|joint| [*joint, 0, 0, 0]).collect();
        let weights: Vec<u8> =
            [[1.0_f32, 0.0, 0.0, 0.0]; 6].as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
        for (number, bytes) in [(2, joints), (3, weights)] {
            let uri = format!("data:;base64,{}", BASE64.encode(&bytes));
            let lists = [
                ("buffers", json!({"byteLength": bytes.len(), "uri": uri})),
                ("bufferViews", json!({"buffer": number, "byteLength": bytes.len()})),
            ];
            for (list, entry) in lists {
                file[list].as_array_mut().unwrap().push(entry);
            }
        }
        let accessors = file["accessors"].as_array_mut().unwrap();
        accessors.push(json!({"bufferView": 2, "componentType": 5121, "count": 6, "type": "VEC4"}));
        accessors.push(json!({"bufferView": 3, "componentType": 5126, "count": 6, "type": "VEC4"}));
        accessors.push(json!({"bufferView": 1, "componentType": 5126, "count": 1, "type": "SCALAR"}));
        file["meshes"] =
            json!([{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}}]}]);
        file["skins"] = json!([{"joints": [1, 2]}]);
        file["animations"] = json!([{"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
            "samplers": [{"input": 4, "output": 1}]}]);
        file
    };
    let skin = json!({"mesh": 0, "skin": 0});
    for (second, node, expected) in
        [(1, &skin, json!([[0, 1]])), (0, &skin, json!([])), (1, &json!({"mesh": 0}), json!([]))]
    {
        write(folder, "layers.gltf", &skinned(second, node.clone()));
        assert_eq!(pairs(folder, &["layers.gltf"]), std::slice::from_ref(&expected), "{second} {node}");
        if node == &skin {
            assert_eq!(pairs(folder, &["layers.gltf", "--animation=0", "--times=0"]), [expected], "{second}");
        }
    }
}
