//! A glTF file with several meshes is a scene: `sscc check` checks every node with itself, and every two nodes with
//! each other.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use sscc_testing::models;

use crate::common::{page_data, sscc};
use crate::places::gltf;

/// Pseudo-random numbers in (-1, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / 2_f64.powi(52) - 1.0
    }

    fn corner(&mut self, size: f64) -> [f32; 3] {
        [(); 3].map(|()| (size * self.next()) as f32)
    }
}

/// Triangles that are not connected.
fn soup(random: &mut Numbers, triangles: usize) -> Vec<[f32; 3]> {
    let triangle = |random: &mut Numbers| {
        let place = random.corner(1.0);
        [(); 3].map(|()| {
            let offset = random.corner(0.35);
            [0, 1, 2].map(|k| place[k] + offset[k])
        })
    };
    (0..triangles).flat_map(|_| triangle(random)).collect()
}

fn write(folder: &Path, name: &str, file: &Value) {
    fs::write(folder.join(name), file.to_string()).unwrap();
}

/// Returns the JSON lines of a check. Asserts that the exit code is that of these lines.
fn lines(folder: &Path, args: &[&str]) -> Vec<Value> {
    let run = sscc(folder, &[&["check"], args, &["--json"]].concat());
    assert!(run.code == Some(0) || run.code == Some(1), "{run:?}");
    let lines = run.json();
    assert_eq!(run.code == Some(1), lines.iter().any(|line| line["count"] != 0), "{run:?}");
    lines
}

#[test]
fn every_node_of_a_scene_is_checked_with_itself_and_with_every_other_node() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let random = &mut Numbers(5);
    let (mut compared, mut collided) = (0, 0);
    for case in 0..4 {
        let soups: Vec<Vec<[f32; 3]>> = (0..4).map(|_| soup(random, 16)).collect();
        let names = ["Body", "Coat", "Body", "Hat\nred"];
        let meshes: Vec<(&str, &[[f32; 3]])> =
            names.into_iter().zip(soups.iter().map(Vec::as_slice)).collect();
        // Mesh 1 is at two nodes, mesh 3 below a node that turns it.
        let moved = |random: &mut Numbers, mesh: usize| json!({"mesh": mesh, "name": format!("node {mesh}"), "translation": random.corner(0.8), "scale": [1, -1, 0.5]});
        let nodes = json!([
            moved(random, 0), moved(random, 1), {"children": [4], "rotation": [0, 0.6, 0, 0.8]},
            moved(random, 1), moved(random, 3), moved(random, 2)]);
        write(folder, "scene.gltf", &gltf(&meshes, nodes.clone()));
        write(folder, "copy.gltf", &gltf(&meshes, nodes));
        let clearance: &[&str] = if case % 2 == 0 { &[] } else { &["--clearance", "0.1"] };
        let scene = lines(folder, &[&["scene.gltf"], clearance].concat());
        let (between, within): (Vec<_>, Vec<_>) =
            scene.iter().partition(|line| line.get("against_node").is_some());
        let shown = [(0, 0), (1, 1), (3, 1), (4, 3), (5, 2)];
        assert_eq!(within.len(), shown.len());
        for (line, (node, mesh)) in within.iter().zip(shown) {
            assert_eq!((&line["node"], &line["node_name"]), (&json!(node), &json!(format!("node {mesh}"))));
            if clearance.is_empty() {
                // The place that a node gives a mesh does not change the collisions of the mesh with itself.
                let alone = lines(folder, &[&format!("scene.gltf#{mesh}")]);
                assert_eq!(line["pairs"], alone[0]["pairs"], "{line}");
            }
        }
        let mut left = between.len();
        for (i, (a, of_a)) in shown.iter().enumerate() {
            for (b, of_b) in &shown[i + 1..] {
                let [a_file, b_file] = [format!("scene.gltf#{of_a}"), format!("copy.gltf#{of_b}")];
                let alone = lines(folder, &[&[a_file.as_str(), "--against", &b_file], clearance].concat());
                let is_at =
                    |line: &Value, key: &str, node: i32| line.get(key).is_none_or(|found| *found == node);
                let is_of = |line: &&Value| is_at(line, "node", *a) && is_at(line, "against_node", *b);
                let alone: Vec<&Value> = alone.iter().filter(is_of).collect();
                assert_eq!(alone.len(), 1, "{a} {b}");
                let found = between.iter().find(|line| line["node"] == *a && line["against_node"] == *b);
                compared += 1;
                collided += usize::from(found.is_some());
                left -= usize::from(found.is_some());
                assert_eq!(
                    found.map_or(json!([]), |line| line["pairs"].clone()),
                    alone[0]["pairs"],
                    "{a} {b}"
                );
            }
        }
        assert_eq!(left, 0);
        let text = sscc(folder, &["check", "scene.gltf"]).stdout;
        assert!(text.contains("node 4 node 3 ") && text.contains(" comparisons: "), "{text}");
    }
    assert!(compared == 40 && (5..35).contains(&collided), "{compared} {collided}");
}

/// Groups have the names of nodes, meshes and materials. The pairs are compared with those of the whole scene whose
/// triangles have these names.
#[test]
fn groups_of_scenes_hold_within_and_between_nodes() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let random = &mut Numbers(11);
    let soups: Vec<Vec<[f32; 3]>> = (0..3).map(|_| soup(random, 24)).collect();
    let names = ["body", "shirt", "hat"];
    let meshes: Vec<(&str, &[[f32; 3]])> = names.into_iter().zip(soups.iter().map(Vec::as_slice)).collect();
    let nodes = json!([{"mesh": 0, "name": "Ann"}, {"mesh": 1, "name": "Ann's shirt"}, {"mesh": 2},
        {"mesh": 1, "name": "pocket, left", "translation": [0.1, 0.2, 0]}]);
    let mut file = gltf(&meshes, nodes);
    file["materials"] = json!([{"name": "cloth"}, {}]);
    file["meshes"][1]["primitives"][0]["material"] = json!(0);
    file["meshes"][2]["primitives"][0]["material"] = json!(1);
    write(folder, "scene.gltf", &file);
    // The names of each node.
    let of_node: [&[&str]; 4] =
        [&["Ann", "body"], &["Ann's shirt", "shirt", "cloth"], &["hat"], &["pocket, left", "shirt", "cloth"]];
    let all = lines(folder, &["scene.gltf"]);
    let pairs = |lines: &[Value], a: usize, b: usize| -> Value {
        let is_of = |line: &&Value| {
            let other = line.get("against_node").map_or(a, |node| node.as_u64().unwrap() as usize);
            line["node"] == a && other == b
        };
        lines.iter().find(is_of).map_or(json!([]), |line| line["pairs"].clone())
    };
    let mut differences = 0;
    for [a, b] in [
        ["Ann", "shirt"],
        ["cloth", "cloth"],
        ["pocket, left", "Ann's shirt"],
        ["hat", "Ann"],
        ["hat", "hat"],
    ] {
        let matches = |i: usize, j: usize| {
            [[i, j], [j, i]].iter().any(|[i, j]| of_node[*i].contains(&a) && of_node[*j].contains(&b))
        };
        for (flag, counts_where) in [("--ignore-groups", false), ("--only-groups", true)] {
            for more in [&[][..], &["--clearance", "0.05"], &["--limit", "1"]] {
                let rule = format!("{flag}={a},{b}");
                let found = lines(folder, &[&["scene.gltf", &rule], more].concat());
                let whole = match more.is_empty() {
                    true => all.clone(),
                    false => lines(
                        folder,
                        &[&["scene.gltf"], &more[..more.len() * usize::from(more[0] != "--limit")]].concat(),
                    ),
                };
                for i in 0..4 {
                    for j in i..4 {
                        let (found, whole) = (pairs(&found, i, j), pairs(&whole, i, j));
                        let wanted = if matches(i, j) == counts_where { whole.clone() } else { json!([]) };
                        differences += usize::from(wanted != whole);
                        if more.first() == Some(&"--limit") {
                            let found = found.as_array().unwrap();
                            let wanted = wanted.as_array().unwrap();
                            assert_eq!(found.len(), wanted.len().min(1), "{rule} {i} {j}");
                            assert!(found.iter().all(|pair| wanted.contains(pair)), "{rule} {i} {j}");
                        } else {
                            assert_eq!(found, wanted, "{rule} {more:?} {i} {j}");
                        }
                    }
                }
            }
        }
    }
    assert!(differences > 50, "{differences}");
    // With --group-by, only the names of that kind are groups.
    let refused =
        |args: &[&str]| sscc(folder, &[&["check", "scene.gltf"], args].concat()).refusal().to_owned();
    assert_eq!(
        refused(&["--ignore-groups=Ann,cloth", "--group-by=node"]),
        "error: --ignore-groups Ann,cloth: no triangle is in a group 'cloth'; groups: 'Ann', 'Ann's shirt', '#2', 'pocket, left'"
    );
    assert_eq!(
        refused(&["--only-groups=Ann,#2"]),
        "error: --only-groups Ann,#2: no triangle is in a group '#2'; groups: 'Ann', 'body', '#0', 'Ann's shirt', \
         'shirt', 'cloth', 'hat', 'pocket, left'"
    );
    assert!(
        sscc(folder, &["check", "scene.gltf", "--only-groups=hat,#2", "--group-by=node"]).code == Some(2)
    );
    let text = sscc(folder, &["check", "scene.gltf", "--only-groups=hat,hat"]).stdout;
    assert!(text.contains("pairs of groups that do not count"), "{text}");
}

/// The frames of a node are written with the checked positions, and can be read again.
#[test]
fn frames_of_a_node_are_written() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    write(folder, "pass.gltf", &passing());
    let animated = ["pass.gltf", "--animation=pass", "--times=0,0.5,1"];
    let out = ["--node=needle", "--frames-out=needle.npy"];
    let numbers = |name: &str| {
        let array =
            sscc_io::FrameReader::open(&folder.join(name), &needle(), &folder.join("pass.gltf")).unwrap();
        let mut positions = Vec::new();
        let frame = |frame: usize| {
            array.read(frame, &mut positions).unwrap();
            positions.iter().map(|x| x.z).collect::<Vec<_>>()
        };
        (0..array.len()).map(frame).collect::<Vec<_>>()
    };
    let wanted = [[1.0, 1.0, 1.5], [-1.0, -1.0, -0.5], [-3.0, -3.0, -2.5]];
    lines(folder, &[&animated[..], &out].concat());
    assert_eq!(numbers("needle.npy"), wanted);
    // With --continuous, too, each time is written once.
    lines(folder, &[&animated[..], &out, &["--continuous"]].concat());
    assert_eq!(numbers("needle.npy"), wanted);
    // The written frames can be checked as frames of the mesh without its animation.
    let of_frames = ["pass.gltf#needle", "--frames=needle.npy", "--against=pass.gltf#sheet", "--continuous"];
    assert_eq!(lines(folder, &of_frames)[0]["pairs"], json!([[0, 0]]));
    lines(folder, &["pass.gltf#needle", "--frames=needle.npy", "--frames-out=copy.npy"]);
    assert_eq!(fs::read(folder.join("copy.npy")).unwrap(), fs::read(folder.join("needle.npy")).unwrap());

    let refused = |args: &[&str]| sscc(folder, &[&["check"], args].concat()).refusal().to_owned();
    let several = refused(&[&animated[..], &["--frames-out=all.npy"]].concat());
    assert_eq!(
        several,
        "error: all.npy: several nodes have a mesh: name one by --node, or for a file at rest as FILE#NODE"
    );
    assert!(!folder.join("all.npy").exists());
    assert!(
        refused(&[&animated[..], &["--node=needle", "--frames-out=a.txt"]].concat())
            .contains("must end in .npy")
    );
    let input = ["pass.gltf#needle", "--frames=needle.npy", "--frames-out=needle.npy"];
    assert!(refused(&input).contains("the output is an input"));
    assert!(
        refused(&[&animated[..], &["--node=hat"]].concat())
            .contains("no node 'hat' shows a mesh with triangles")
    );
}

/// Returns the mesh of the node that moves.
fn needle() -> sscc::TriMesh {
    let corners = [[1.0, 1.0, 1.0], [1.5, 1.0, 1.0], [1.0, 1.0, 1.5]].map(Into::into);
    sscc::TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap()
}

/// Groups between two files: names may be those of either file.
#[test]
fn groups_hold_between_two_meshes() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let sheet = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 9 9 9\nv 9 8 9\nv 8 9 9\ng neck\nf 1 2 3\ng arm\nusemtl skin\nf 4 5 6\n";
    let needles = "o shirt\nv 1 1 -1\nv 1 1 1\nv 1.2 1 1\nv 2 1 -1\nv 2 1 1\nv 2.2 1 1\ng hem\nf 1 2 3\ng button\nf 4 5 6\n";
    fs::write(folder.join("sheet.obj"), sheet).unwrap();
    fs::write(folder.join("needles.obj"), needles).unwrap();
    let check = |args: &[&str]| -> Value {
        lines(folder, &[&["sheet.obj", "--against=needles.obj"], args].concat())[0]["pairs"].clone()
    };
    assert_eq!(check(&[]), json!([[0, 0], [0, 1]]));
    assert_eq!(check(&["--ignore-groups=neck,hem"]), json!([[0, 1]]));
    assert_eq!(check(&["--ignore-groups=hem,neck"]), json!([[0, 1]]));
    assert_eq!(check(&["--only-groups=neck,hem"]), json!([[0, 0]]));
    assert_eq!(check(&["--ignore-groups=neck,shirt"]), json!([]));
    assert_eq!(check(&["--ignore-groups=skin,shirt"]), json!([[0, 0], [0, 1]]));
    let text = sscc(folder, &["check", "sheet.obj", "--against=needles.obj", "--ignore-groups=neck,shirt"]);
    assert!(
        text.stdout.contains("pairs of groups that do not count and pairs within either mesh"),
        "{text:?}"
    );
    let refused = |args: &[&str]| {
        sscc(folder, &[&["check", "sheet.obj", "--against=needles.obj"], args].concat()).refusal().to_owned()
    };
    assert!(
        refused(&["--ignore-groups=neck,cuff"])
            .contains("no triangle is in a group 'cuff'; groups: 'skin', ")
    );
    // The triangle of the group "arm" is far from the needles.
    assert_eq!(check(&["--ignore-groups=arm,hem"]), json!([[0, 0], [0, 1]]));
    fs::write(folder.join("n.txt"), "0 1").unwrap();
    let numbers = refused(&["--group-by=n.txt", "--ignore-groups=0,1"]);
    assert!(numbers.contains("n.txt: its numbers are those of one mesh"), "{numbers}");
    assert!(refused(&["--group-by=node"]).contains("it changes nothing without --ignore-groups"));
}

/// A node that moves through another one in one second.
fn passing() -> Value {
    let sheet = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    moving(&sheet, &[[1.0, 1.0, 1.0], [1.5, 1.0, 1.0], [1.0, 1.0, 1.5]], [0.0, 0.0, -4.0])
}

/// A sheet, and a needle that is shifted in one second.
fn moving(sheet: &[[f32; 3]], needle: &[[f32; 3]], [x, y, z]: [f32; 3]) -> Value {
    let nodes = json!([{"mesh": 0, "name": "sheet"}, {"mesh": 1, "name": "needle"}]);
    let mut file = gltf(&[("sheet", sheet), ("needle", needle)], nodes);
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let bytes = [floats(&[0.0, 1.0]), floats(&[0.0, 0.0, 0.0, x, y, z])].concat();
    let add = |list: &mut Value, items: Value| {
        list.as_array_mut().unwrap().extend(items.as_array().unwrap().clone())
    };
    add(
        &mut file["buffers"],
        json!([{"byteLength": 32, "uri": format!("data:;base64,{}", BASE64.encode(bytes))}]),
    );
    add(
        &mut file["bufferViews"],
        json!([
        {"buffer": 2, "byteLength": 8}, {"buffer": 2, "byteOffset": 8, "byteLength": 24}]),
    );
    add(
        &mut file["accessors"],
        json!([
        {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
        {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"}]),
    );
    file["animations"] = json!([{
        "name": "pass",
        "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
        "samplers": [{"input": 2, "output": 3}]}]);
    file
}

#[test]
fn nodes_of_animations_are_compared_on_request() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    write(folder, "pass.gltf", &passing());
    let check = |more: &[&str]| lines(folder, &[&["pass.gltf", "--animation=pass"], more].concat());
    assert_eq!(check(&["--times=0,0.5,1", "--continuous"]).len(), 4);
    let found = check(&["--times=0,0.5,1", "--continuous", "--between-nodes"]);
    assert_eq!(found.len(), 5);
    let line = &found[4];
    assert_eq!(
        (&line["node_name"], &line["against_node_name"], &line["index"], &line["pairs"]),
        (&json!("sheet"), &json!("needle"), &json!(0), &json!([[0, 0]]))
    );
    assert!((line["times"][0].as_f64().unwrap() - 0.5).abs() < 1e-9, "{line}");
    // Nothing touches at the times 0, 0.5 and 1, but at 0.25 two nodes do.
    assert_eq!(check(&["--times=0,0.5,1", "--between-nodes"]).len(), 6);
    let at = check(&["--times=0.25", "--between-nodes"]);
    assert_eq!((at.len(), &at[2]["against_node"]), (3, &json!(1)));
    // At rest one is a unit above the other, and their AABBs do not overlap.
    assert_eq!(lines(folder, &["pass.gltf"]).len(), 2);
    assert_eq!(lines(folder, &["pass.gltf", "--clearance", "1"]).len(), 2);
    let near = lines(folder, &["pass.gltf", "--clearance", "1.0000001"]);
    assert_eq!((near.len(), &near[2]["distance"], &near[2]["colliding"]), (3, &json!(1.0), &json!(false)));
    let text = |more: &[&str]| {
        sscc(folder, &[&["check", "pass.gltf", "--animation=pass", "--times=0"], more].concat()).stdout
    };
    assert!(text(&[]).contains("apart from pairs of different nodes and pairs with common vertices"));
    assert!(text(&["--between-nodes"]).contains("apart from pairs with common vertices"));
    let of_nodes = |args: &[&str]| {
        let found = lines(folder, args);
        found.iter().map(|line| (line["node"].clone(), line["pairs"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(of_nodes(&["pass.gltf", "--between-nodes"]), of_nodes(&["pass.gltf"]));
}

/// With `--ignore-rest`, the pairs of two nodes that collide at the first time count at no time; with
/// `--ignore-rest=1`, neither do the pairs within one ring of them.
#[test]
fn pairs_of_nodes_at_the_first_time_are_ignored() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [4.0, 4.0, 0.0]];
    let sheet = [0, 1, 2, 1, 3, 2].map(|corner: usize| corners[corner]);
    let needle = [[1.0, 1.0, -0.5], [1.25, 1.0, 0.5], [1.0, 1.25, 0.5]];
    write(folder, "drag.gltf", &moving(&sheet, &needle, [2.0, 2.0, 0.0]));
    let check = |more: &[&str]| {
        let args = ["drag.gltf", "--animation=pass", "--times=0,1", "--between-nodes"];
        let found = lines(folder, &[&args[..], more].concat());
        let between = found.iter().filter(|line| line.get("against_node").is_some());
        let between = between.map(|line| json!([line["index"], line["pairs"]])).collect::<Vec<_>>();
        (between, found[0]["ignored"].clone())
    };
    let (first, second) = (json!([0, [[0, 0]]]), json!([1, [[1, 0]]]));
    assert_eq!(check(&[]), (vec![first, second.clone()], json!(null)));
    for more in [&["--ignore-rest"][..], &["--ignore-rest", "--limit=1"], &["--ignore-rest", "--first"]] {
        assert_eq!(check(more), (vec![second.clone()], json!(1)), "{more:?}");
    }
    assert_eq!(check(&["--ignore-rest=1"]), (vec![], json!(2)));
    let near = check(&["--ignore-rest", "--clearance=0.125"]);
    assert_eq!(near, (vec![second], json!(1)));
    // On its way the needle touches both triangles.
    assert_eq!(check(&["--continuous"]).0, [json!([0, [[0, 0], [1, 0]]])]);
    assert_eq!(check(&["--continuous", "--ignore-rest"]).0, [json!([0, [[1, 0]]])]);
    assert_eq!(check(&["--continuous", "--ignore-rest=1"]).0, [json!(null); 0]);
    let text = sscc(
        folder,
        &["check", "drag.gltf", "--animation=pass", "--times=0,1", "--between-nodes", "--ignore-rest=1"],
    );
    assert!(
        text.stdout.contains("free, apart from 2 ignored pairs and pairs with common vertices"),
        "{text:?}"
    );
    // A report shows the pairs of the nodes.
    let report = ["--report=drag.html"];
    assert_eq!(check(&report).0.len(), 2);
    let data = page_data(&fs::read_to_string(folder.join("drag.html")).unwrap());
    let playback = &data["scene"]["playback"];
    assert_eq!(playback["bodies"][0]["pairs"], json!([1, 1]), "{playback}");
    let numbers = |name: &Value| -> Vec<u32> {
        let bytes = BASE64.decode(data["arrays"][name.as_str().unwrap()].as_str().unwrap()).unwrap();
        bytes.chunks_exact(4).map(|chunk| u32::from_le_bytes(chunk.try_into().unwrap())).collect()
    };
    let contacts = &playback["contacts"];
    assert_eq!(numbers(&contacts["offsets"]), [0, 1, 1, 2, 2]);
    assert_eq!(numbers(&contacts["pairs"]), [0, 0, 1, 0]);
    assert_eq!(numbers(&contacts["seconds"]), [1, 1]);
    assert_eq!(numbers(&playback["curves"]["offsets"])[2], 2);
}

/// A file of contact curves has those of one mesh, or those between two.
#[test]
fn curves_of_nodes_that_are_compared_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let sheet = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let needle = [[1.0, 1.0, -0.5], [1.25, 1.0, 0.5], [1.0, 1.25, 0.5]];
    write(folder, "two.gltf", &moving(&sheet, &needle, [0.0, 0.0, 4.0]));
    let check = |args: &[&str]| sscc(folder, &[&["check"], args, &["--curves=c.obj"]].concat());
    let animated = ["two.gltf", "--animation=pass", "--times=0", "--between-nodes"];
    for (args, way_out) in [
        (&["two.gltf"][..], "name one as FILE#NODE, and a second one by --against FILE#NODE"),
        (&animated, "name one by --node"),
    ] {
        let refused = check(args);
        let cause = "error: c.obj: contact curves are those of one mesh or between two, but two.gltf shows several nodes: ";
        assert_eq!(refused.refusal(), format!("{cause}{way_out}"));
        assert!(!folder.join("c.obj").exists());
    }
    let curves = |args: &[&str]| {
        let run = check(args);
        let text = fs::read_to_string(folder.join("c.obj")).unwrap();
        (run.code, text.lines().next().unwrap().split(';').next().unwrap().to_owned())
    };
    assert_eq!(
        curves(&["two.gltf#sheet", "--against=two.gltf#needle"]),
        (Some(1), "# contact curves: 1".to_owned())
    );
    assert_eq!(
        curves(&[&animated[..], &["--node=needle"]].concat()),
        (Some(0), "# contact curves: 0".to_owned())
    );
}

/// A mesh at two nodes is one mesh, whose nodes are compared on request.
#[test]
fn nodes_of_one_mesh_are_compared_on_request() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let triangle = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let nodes = json!([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b", "translation": [1, 1, 0]}]);
    write(folder, "two.gltf", &gltf(&[("mesh", &triangle)], nodes));
    assert_eq!(lines(folder, &["two.gltf"]).len(), 1);
    let found = lines(folder, &["two.gltf", "--between-nodes"]);
    assert_eq!(
        (found.len(), &found[2]["pairs"], &found[2]["against_node_name"]),
        (3, &json!([[0, 0]]), &json!("b"))
    );
    fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let refused = |args: &[&str]| sscc(folder, &[&["check"], args, &["--between-nodes"]].concat());
    let cause =
        "error: a.obj: only the nodes of a .glb, .gltf or .vrm as a whole are compared with each other";
    assert_eq!(refused(&["a.obj"]).refusal(), cause);
    assert!(refused(&["a.obj", "two.gltf"]).stderr.contains("a.obj: only the nodes"));
    assert!(refused(&["two.gltf#a"]).refusal().contains("as a whole"));
}

#[test]
fn scenes_without_meshes_are_refused_in_one_line() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let two: [(&str, &[[f32; 3]]); 2] = [("a", &triangle), ("b", &triangle)];
    let mut cameras = gltf(&two, json!([{"camera": 0}]));
    cameras["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]);
    write(folder, "cameras.gltf", &cameras);
    let run = sscc(folder, &["check", "cameras.gltf"]);
    assert_eq!(run.refusal(), "error: cameras.gltf: no node of the file shows a mesh with triangles");
    // A mesh of points has no triangles: the others are checked.
    let mut points = gltf(&two, json!([{"mesh": 0}, {"mesh": 1}]));
    points["meshes"][0]["primitives"][0]["mode"] = json!(0);
    write(folder, "points.gltf", &points);
    let found = lines(folder, &["points.gltf"]);
    assert_eq!((found.len(), &found[0]["node"]), (1, &json!(1)));
}

/// A strip whose triangles all have repeated corners has no triangles: the other nodes are checked.
#[test]
fn nodes_without_triangles_are_left_out_with_a_warning() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut file = gltf(&[("a", &triangle), ("b", &triangle)], json!([{"mesh": 0}, {"mesh": 1}]));
    file["meshes"][0]["primitives"][0]["mode"] = json!(5);
    file["meshes"][0]["primitives"][0]["indices"] = json!(2);
    let add = |list: &mut Value, item: Value| list.as_array_mut().unwrap().push(item);
    let corners = BASE64.encode([0_u8, 0, 1, 1]);
    add(&mut file["buffers"], json!({"byteLength": 4, "uri": format!("data:;base64,{corners}")}));
    add(&mut file["bufferViews"], json!({"buffer": 2, "byteLength": 4}));
    add(
        &mut file["accessors"],
        json!({"bufferView": 2, "componentType": 5121, "count": 4, "type": "SCALAR"}),
    );
    write(folder, "strip.gltf", &file);
    let run = sscc(folder, &["check", "strip.gltf", "--json"]);
    assert_eq!((run.code, run.json().len(), &run.json()[0]["node"]), (Some(0), 1, &json!(1)), "{run:?}");
    let warning =
        "warning: strip.gltf: nodes[0]: meshes[0] has only strips whose triangles have repeated corners";
    assert!(run.stderr.starts_with(warning) && run.stderr.lines().count() == 1, "{run:?}");
    let alone = sscc(folder, &["check", "strip.gltf#a"]);
    assert!(alone.refusal().starts_with("error: strip.gltf#a: meshes[0]: it has only strips "), "{alone:?}");
}

/// A warning names an extension that shows a mesh at many places: its instances are not compared.
#[test]
fn a_warning_names_the_extension_of_instances() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let instanced = json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {}}}});
    write(folder, "one.gltf", &gltf(&[("a", &triangle)], json!([instanced])));
    write(folder, "two.gltf", &gltf(&[("a", &triangle), ("b", &triangle)], json!([{"mesh": 1}, instanced])));
    for (file, node) in [("one.gltf", 0), ("two.gltf", 1)] {
        let run = sscc(folder, &["check", file]);
        let note = format!("warning: {file}: nodes[{node}]: the extension EXT_mesh_gpu_instancing");
        assert!(run.stderr.starts_with(&note) && run.stderr.lines().count() == 1, "{run:?}");
    }
}

/// The pairs of two nodes of the robot are those of the detector between two files, each of which shows one of the
/// nodes.
#[test]
fn published_scenes_are_compared_part_by_part() {
    let Some(models) = models("published_scenes_are_compared_part_by_part") else { return };
    let folder = models.join("morph");
    let scene = lines(&folder, &["RobotExpressive.glb"]);
    let between: Vec<&Value> = scene.iter().filter(|line| line.get("against_node").is_some()).collect();
    assert_eq!(scene.len() - between.len(), 14);
    assert!(between.len() > 5, "{}", between.len());
    let copy = tempfile::tempdir().unwrap();
    fs::copy(folder.join("RobotExpressive.glb"), copy.path().join("copy.glb")).unwrap();
    fs::copy(folder.join("RobotExpressive.glb"), copy.path().join("robot.glb")).unwrap();
    for line in between {
        let [a, b] = ["node_name", "against_node_name"].map(|key| line[key].as_str().unwrap());
        let args = [format!("robot.glb#{a}"), format!("copy.glb#{b}")];
        let run = sscc(copy.path(), &["check", &args[0], "--against", &args[1], "--json"]);
        // A name that does not select one mesh is refused.
        if run.code == Some(2) {
            continue;
        }
        assert_eq!(run.json()[0]["pairs"], line["pairs"], "{a} {b}");
    }
}
