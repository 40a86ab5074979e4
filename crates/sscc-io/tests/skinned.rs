//! Real skinned and animated models: positions and colliding pairs match answers of independent programs (see the README
//! of the models).
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use glam::DVec3;
use serde_json::Value;
use sscc::intersect_triangle_triangle;
use sscc_io::gltf::{self, AnimatedScene, MeshNode, SkinWeights, read_scene};
use sscc_testing::models;

type Pairs = BTreeSet<(u64, u64)>;

/// Records of one answers file with their scene.
fn each_record(folder: &Path, mut run: impl FnMut(&AnimatedScene, &Value, &str)) {
    let entries =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut files: Vec<String> = entries.filter(|name| name.ends_with(".answers.json")).collect();
    files.sort();
    assert!(files.len() >= 8, "{files:?}");
    for file in files {
        let records: Value = serde_json::from_slice(&fs::read(folder.join(&file)).unwrap()).unwrap();
        for record in records.as_array().unwrap() {
            let scene = read_scene(&folder.join(record["file"].as_str().unwrap())).unwrap();
            let place = format!("{file} {} {} {}", record["node"], record["animation"], record["weights"]);
            run(&scene, record, &place);
        }
    }
}

fn index(value: &Value) -> usize {
    value.as_u64().unwrap() as usize
}

fn mesh_node<'a>(scene: &'a AnimatedScene, record: &Value) -> &'a MeshNode {
    let node = index(&record["node"]);
    scene.mesh_nodes().iter().find(|mesh_node| mesh_node.node() == node).unwrap()
}

fn reading(record: &Value) -> SkinWeights {
    match record["weights"].as_str().unwrap() {
        "as stored" => SkinWeights::AsStored,
        "normalized" => SkinWeights::Normalized,
        other => panic!("{other}"),
    }
}

/// Positions of a record's mesh in one of its frames.
fn positions(scene: &AnimatedScene, record: &Value, frame: &Value, weights: SkinWeights) -> Vec<DVec3> {
    let mut positions = Vec::new();
    let time = frame["time"].as_f64().unwrap();
    let (node, animation) = (index(&record["node"]), index(&record["animation"]));
    scene.positions(node, Some(animation), time, weights, &mut positions).unwrap();
    positions
}

fn pairs(value: &Value) -> Pairs {
    let pair = |pair: &Value| (pair[0].as_u64().unwrap(), pair[1].as_u64().unwrap());
    value.as_array().unwrap().iter().map(pair).collect()
}

/// Pairs of triangles that share no welded vertex and have a common point, each tested.
fn colliding_pairs(mesh_node: &MeshNode, positions: &[DVec3]) -> Pairs {
    let classes = mesh_node.weld_classes();
    let triangles: Vec<_> = mesh_node
        .faces()
        .iter()
        .map(|face| {
            let x = face.map(|v| positions[v as usize]);
            let (min, max) = (x[0].min(x[1]).min(x[2]), x[0].max(x[1]).max(x[2]));
            (min, max, x, face.map(|v| classes[v as usize]))
        })
        .collect();
    let mut pairs = Pairs::new();
    for (j, b) in triangles.iter().enumerate() {
        for (i, a) in triangles[..j].iter().enumerate() {
            if a.0.cmple(b.1).all()
                && b.0.cmple(a.1).all()
                && !a.3.iter().any(|class| b.3.contains(class))
                && intersect_triangle_triangle(&a.2, &b.2)
            {
                pairs.insert((i as u64, j as u64));
            }
        }
    }
    pairs
}

#[test]
fn sizes_and_weld_classes_are_known() {
    let Some(folder) = models("sizes_and_weld_classes_are_known") else { return };
    each_record(&folder.join("skinned"), |scene, record, place| {
        let mesh_node = mesh_node(scene, record);
        assert_eq!(mesh_node.rest_positions().len(), index(&record["vertices"]), "{place}");
        assert_eq!(mesh_node.faces().len(), index(&record["triangles"]), "{place}");
        assert_eq!(mesh_node.mesh(), index(&record["mesh"]), "{place}");
        assert_eq!(mesh_node.mesh_name(), record["mesh_name"].as_str(), "{place}");
        assert_eq!(mesh_node.skin(), record["skin"].as_u64().map(|skin| skin as usize), "{place}");
        assert_eq!(mesh_node.morph_targets(), index(&record["morph_targets"]), "{place}");
        let animation = &scene.animations()[index(&record["animation"])];
        assert_eq!(animation.name.as_deref(), record["animation_name"].as_str(), "{place}");
        for frame in record["frames"].as_array().unwrap() {
            let time = frame["time"].as_f64().unwrap();
            // Some animations begin later than at 0; players then hold their first key frame.
            assert!(0.0 < time && time < animation.last_time, "{place}: {animation:?}");
            assert!((0.0..0.1).contains(&animation.first_time), "{place}: {animation:?}");
        }
        let classes: BTreeSet<u32> = mesh_node.weld_classes().iter().copied().collect();
        assert_eq!(classes.len(), index(&record["welded_vertices"]), "{place}");
        assert_eq!(classes.len(), index(&record["welded_vertices_by_stored_attributes"]), "{place}");
        // Three digits are listed.
        let (error, known) =
            (mesh_node.largest_weight_error(), record["largest_weight_sum_error"].as_f64().unwrap());
        assert!((error - known).abs() <= 5e-3 * known, "{place}: {error}");
    });
}

#[test]
fn positions_have_the_known_bounds() {
    let Some(folder) = models("positions_have_the_known_bounds") else { return };
    let mut frames = 0;
    each_record(&folder.join("skinned"), |scene, record, place| {
        for frame in ["frames", "dropped"].iter().flat_map(|list| record[list].as_array().unwrap()) {
            if frame["bounds"].is_null() {
                continue;
            }
            frames += 1;
            let read = |number: &Value| -> DVec3 {
                let numbers: Vec<f64> =
                    number.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
                DVec3::from_slice(&numbers)
            };
            let known = (read(&frame["bounds"][0]), read(&frame["bounds"][1]));
            let size = (known.1 - known.0).max_element();
            let mut readings = vec![reading(record)];
            if record["largest_weight_sum_error"].as_f64().unwrap() < 1e-6 {
                readings.push(SkinWeights::Normalized);
            }
            for weights in readings {
                let positions = positions(scene, record, frame, weights);
                let min = positions.iter().copied().reduce(DVec3::min).unwrap();
                let max = positions.iter().copied().reduce(DVec3::max).unwrap();
                let error = (min - known.0).abs().max((max - known.1).abs()).max_element() / size;
                assert!(error < 1e-6, "{place} at {}: {error} of the size", frame["time"]);
            }
        }
    });
    assert!(frames >= 170, "{frames}");
}

#[test]
fn pairs_are_known() {
    let Some(folder) = models("pairs_are_known") else { return };
    let (mut kept, mut dropped, mut count) = (0, 0, 0);
    each_record(&folder.join("skinned"), |scene, record, place| {
        let mesh_node = mesh_node(scene, record);
        let found = |frame| colliding_pairs(mesh_node, &positions(scene, record, frame, reading(record)));
        for frame in record["frames"].as_array().unwrap() {
            let found = found(frame);
            assert_eq!(found, pairs(&frame["pairs"]), "{place} at {}", frame["time"]);
            kept += 1;
            count += found.len();
        }
        for frame in record["dropped"].as_array().unwrap() {
            let (found, certain) = (found(frame), pairs(&frame["pairs"]));
            let uncertain = pairs(&frame["uncertain"]);
            assert!(found.is_superset(&certain), "{place} at {}", frame["time"]);
            let rest: Pairs = found.difference(&certain).copied().collect();
            assert!(rest.is_subset(&uncertain), "{place} at {}: {rest:?}", frame["time"]);
            dropped += 1;
        }
    });
    assert!(kept >= 170 && dropped > 0 && count > 8000);
}

/// Without a skin, the node transform is the only difference from the reduced model of the same mesh.
#[test]
fn morph_targets_agree_with_the_reduced_model() {
    let Some(folder) = models("morph_targets_agree_with_the_reduced_model") else { return };
    for file in ["AnimatedMorphSphere.gltf", "MorphStressTest.gltf", "RobotExpressive.glb"] {
        let path = folder.join("morph").join(file);
        let (model, scene) = (gltf::read(&path, None).unwrap(), read_scene(&path).unwrap());
        let morphed = scene.mesh_nodes().iter().find(|node| node.morph_targets() > 0).unwrap();
        assert_eq!(morphed.faces(), model.mesh.faces(), "{file}");
        assert_eq!(morphed.rest_positions(), model.mesh.rest_positions(), "{file}");
        assert_eq!(morphed.morph_targets(), model.modes.rank(), "{file}");
        let placed = gltf::read_placed_mesh(&path, Some(&model.mesh_name)).unwrap();
        assert_eq!(placed.rest_positions(), model.mesh.rest_positions(), "{file}");
        // Its place is that of the scene, without weights of morph targets.
        let mut expected = Vec::new();
        scene.positions(morphed.node(), None, 0.0, SkinWeights::Normalized, &mut expected).unwrap();
        assert_eq!(placed.node(0), Some(morphed.node()), "{file}");
        if model.default_weights.iter().all(|weight| *weight == 0.0) {
            assert_eq!(placed.to_mesh(0).unwrap().rest_positions(), expected, "{file}");
        }
        let mut positions = Vec::new();
        for animation in 0..scene.animations().len() {
            let pose = scene.pose(Some(animation), 0.5 * scene.animations()[animation].last_time).unwrap();
            for node in scene.mesh_nodes() {
                pose.positions(node.node(), SkinWeights::Normalized, &mut positions).unwrap();
                assert_eq!(positions.len(), node.rest_positions().len());
            }
        }
    }
}
