//! A glTF file with several meshes is a scene: every node with itself, and every two nodes.

use std::fs;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Value, json};
use sscc_testing::models;

use crate::common::sscc;
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

/// The lines of a check, without times and counters.
fn lines(folder: &Path, args: &[&str]) -> Vec<Value> {
    let run = sscc(folder, &[&["check"], args, &["--json"]].concat());
    assert!(run.code == Some(0) || run.code == Some(1), "{run:?}");
    let lines = run.json();
    assert_eq!(run.code == Some(1), lines.iter().any(|line| line["count"] != 0), "{run:?}");
    lines
}

#[test]
fn scenes_are_all_meshes_with_themselves_and_with_each_other() {
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
                // Where a node puts it changes no collision of a mesh with itself.
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

/// A node that moves through another one in one second.
fn passing() -> Value {
    let sheet = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let needle = [[1.0, 1.0, 1.0], [1.5, 1.0, 1.0], [1.0, 1.0, 1.5]];
    let nodes = json!([{"mesh": 0, "name": "sheet"}, {"mesh": 1, "name": "needle"}]);
    let mut file = gltf(&[("sheet", &sheet), ("needle", &needle)], nodes);
    let floats = |numbers: &[f32]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let bytes = [floats(&[0.0, 1.0]), floats(&[0.0, 0.0, 0.0, 0.0, 0.0, -4.0])].concat();
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
    // At the times alone nothing touches but at a quarter of a second.
    assert_eq!(check(&["--times=0,0.5,1", "--between-nodes"]).len(), 6);
    let at = check(&["--times=0.25", "--between-nodes"]);
    assert_eq!((at.len(), &at[2]["against_node"]), (3, &json!(1)));
    let text = |more: &[&str]| {
        sscc(folder, &[&["check", "pass.gltf", "--animation=pass", "--times=0"], more].concat()).stdout
    };
    assert!(text(&[]).contains("apart from pairs of different nodes and pairs with common vertices"));
    assert!(text(&["--between-nodes"]).contains("apart from pairs with common vertices"));
    // Groups and ignored pairs are those within one mesh.
    assert!(text(&["--between-nodes", "--ignore-rest"]).contains("apart from pairs of different nodes"));
    let alone = sscc(folder, &["check", "pass.gltf", "--between-nodes"]);
    assert_eq!(alone.code, Some(2), "{alone:?}");
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

/// The robot of many parts: each two nodes as frames of their own, by the detector between files.
#[test]
fn published_scenes_are_compared_part_by_part() {
    let Some(models) = models("published_scenes_are_compared_part_by_part") else { return };
    let folder = models.join("morph");
    let scene = lines(&folder, &["RobotExpressive.glb"]);
    let between: Vec<&Value> = scene.iter().filter(|line| line.get("against_node").is_some()).collect();
    assert_eq!(scene.len() - between.len(), 14);
    assert!(between.len() > 5, "{}", between.len());
    // Torso and head are the meshes of one node each.
    let copy = tempfile::tempdir().unwrap();
    fs::copy(folder.join("RobotExpressive.glb"), copy.path().join("copy.glb")).unwrap();
    fs::copy(folder.join("RobotExpressive.glb"), copy.path().join("robot.glb")).unwrap();
    for line in between {
        let [a, b] = ["node_name", "against_node_name"].map(|key| line[key].as_str().unwrap());
        let args = [format!("robot.glb#{a}"), format!("copy.glb#{b}")];
        let run = sscc(copy.path(), &["check", &args[0], "--against", &args[1], "--json"]);
        // Some meshes have other names than their nodes.
        if run.code == Some(2) {
            continue;
        }
        assert_eq!(run.json()[0]["pairs"], line["pairs"], "{a} {b}");
    }
}
