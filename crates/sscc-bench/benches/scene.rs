//! Compares the check of a glTF scene of 20 meshes with parry3d-f64, on one thread: `cargo bench -p sscc-bench --bench scene`.
//!
//! Ten hares, five serpents and five springs hang in a cloud, each rotated at random and moved by an animation, so that
//! neighbours pass through each other. Our time is all work of `sscc check --animation --between-nodes` after reading the
//! file and building the detectors: evaluating the animation, testing each node with itself, and testing each two nodes.
//! parry's time is that of refitting each BVH once a frame, all traversals and our exact test; it gets the positions without
//! cost. Both run alternately in one process, and must list the same pairs.
#![allow(clippy::print_stdout)]

mod peer;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use base64::Engine;
use base64::engine::general_purpose::STANDARD as BASE64;
use glam::{DQuat, DVec3};
use parry3d_f64::partitioning::BvhBuildStrategy;
use peer::Peer;
use serde_json::{Value, json};
use sscc::{Pair, TriMesh};
use sscc_bench::Random;
use sscc_io::gltf::{SkinWeights, read_scene};
use sscc_modes::shapes::{hare, serpent, spring};
use sscc_tasks::{AnimationMotion, Detection, DetectionAnswer, MeshMotion, TaskError, Times, detect};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const FRAMES: usize = 11;

const REPETITIONS: usize = 5;

/// The colliding pairs by frame and two nodes; the two are equal for pairs within one node.
type Found = BTreeMap<(usize, usize, usize), Vec<Pair>>;

fn main() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, scene().to_string())?;
    let times: Vec<f64> = (0..FRAMES).map(|frame| frame as f64 / FRAMES as f64).collect();
    let (mut ours, mut parry) = (Found::new(), Found::new());
    let (mut ours_s, mut parry_s) = (Vec::new(), Vec::new());
    for _ in 0..REPETITIONS {
        let mut seconds = |times: &[f64]| -> Result<f64> {
            let start = Instant::now();
            check(&path, times, &mut ours)?;
            Ok(start.elapsed().as_secs_f64())
        };
        // Reading and building take the same time for one frame, so the difference excludes them.
        let (once, all) = (seconds(&times[..1])?, seconds(&times)?);
        ours_s.push((all - once) / (FRAMES - 1) as f64);
        parry_s.push(peer(&path, &times, &mut parry)?);
    }
    assert!(ours == parry, "the answers differ");
    let pairs: usize = ours.values().map(Vec::len).sum();
    let median = |values: &mut Vec<f64>| {
        values.sort_by(f64::total_cmp);
        1e3 * values[values.len() / 2]
    };
    let (a, b) = (median(&mut ours_s), median(&mut parry_s));
    println!("| meshes | frames | colliding pairs | ours, ms a frame | parry, ms a frame | parry/ours |");
    println!("| --- | --- | --- | --- | --- | --- |");
    println!("| 20 | {FRAMES} | {pairs} | {a:.2} | {b:.2} | {:.2} |", b / a);
    Ok(())
}

/// Checks the scene at these times, and adds the colliding pairs.
fn check(path: &Path, times: &[f64], all: &mut Found) -> Result<()> {
    let request = Detection {
        meshes: vec![path.to_owned()],
        motion: MeshMotion::Animation(AnimationMotion {
            animation: Some("pass".into()),
            times: Times::List(times.to_vec()),
            node: None,
            weights: SkinWeights::Normalized,
        }),
        between_nodes: true,
        threads: Some(1),
        ..Detection::default()
    };
    let take = |_: &Path, found: std::result::Result<&DetectionAnswer<'_>, TaskError>| {
        let found = found?;
        if let Some(node) = found.node.filter(|_| !found.pairs.is_empty()) {
            all.insert((found.index, node, found.other_node.unwrap_or(node)), found.pairs.to_vec());
        }
        Ok::<_, TaskError>(ControlFlow::Continue(()))
    };
    Ok(detect(&request, &(), take)?)
}

/// Checks the scene by parry. Returns the seconds per frame, without reading and building.
fn peer(path: &Path, times: &[f64], all: &mut Found) -> Result<f64> {
    let scene = read_scene(path)?;
    let mut meshes = Vec::new();
    for node in scene.mesh_nodes() {
        meshes.push(TriMesh::new(node.rest_positions().to_vec(), node.faces().to_vec())?);
    }
    let build = |mesh| Peer::new(BvhBuildStrategy::Binned, mesh, mesh.rest_positions());
    let mut peers: Vec<Peer<'_>> = meshes.iter().map(build).collect();
    let mut seconds = 0.0;
    for (frame, time) in times.iter().enumerate() {
        let pose = scene.pose(Some(0), *time)?;
        let mut positions = vec![Vec::new(); meshes.len()];
        for (node, positions) in scene.mesh_nodes().iter().zip(&mut positions) {
            pose.positions(node.node(), SkinWeights::Normalized, positions)?;
        }
        let start = Instant::now();
        peers.iter_mut().zip(&positions).for_each(|(peer, positions)| peer.refit(positions));
        let mut found = Vec::new();
        for (a, one) in peers.iter().enumerate() {
            found.push(((frame, a, a), one.with_itself()));
            found.extend((a + 1..peers.len()).map(|b| ((frame, a, b), one.with(&peers[b]))));
        }
        seconds += start.elapsed().as_secs_f64();
        all.extend(found.into_iter().filter(|(_, pairs)| !pairs.is_empty()));
    }
    Ok(seconds / times.len() as f64)
}

/// Returns the scene as a glTF file.
fn scene() -> Value {
    let shapes = [hare(), serpent(), spring()].map(|mesh| {
        let size = mesh.rest_positions().iter().fold(0.0_f64, |size, x| size.max(x.abs().max_element()));
        (mesh, 1.0 / size)
    });
    let random = &mut Random(5);
    let (mut nodes, mut data, mut channels, mut samplers) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let vector =
        |random: &mut Random, size: f64| DVec3::new(random.normal(), random.normal(), random.normal()) * size;
    for number in 0..20 {
        let shape = if number < 10 { 0 } else { 1 + number % 2 };
        let turn = DQuat::from_scaled_axis(vector(random, 1.0));
        let (from, way) = (vector(random, 2.0), vector(random, 1.0));
        let scale = [shapes[shape].1; 3];
        nodes.push(json!({"mesh": shape, "scale": scale, "rotation": turn.to_array()}));
        data.push((floats([from, from + way].iter().flat_map(|x| x.to_array())), "VEC3", 2));
        channels.push(json!({"sampler": number, "target": {"node": number, "path": "translation"}}));
        samplers.push(json!({"input": 0, "output": 7 + number}));
    }
    let mut all = vec![(floats([0.0, 1.0]), "SCALAR", 2)];
    let mut meshes = Vec::new();
    for (mesh, _) in &shapes {
        let (faces, positions) = (mesh.faces(), mesh.rest_positions());
        let indices: Vec<u8> = faces.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        meshes
            .push(json!({"primitives": [{"attributes": {"POSITION": all.len()}, "indices": all.len() + 1}]}));
        all.push((floats(positions.iter().flat_map(|x| x.to_array())), "VEC3", positions.len()));
        all.push((indices, "INDEX", 3 * faces.len()));
    }
    all.extend(data);
    let views =
        all.iter().enumerate().map(|(i, (bytes, ..))| json!({"buffer": i, "byteLength": bytes.len()}));
    let buffers = all.iter().map(|(bytes, ..)| {
        json!({"byteLength": bytes.len(), "uri": format!("data:;base64,{}", BASE64.encode(bytes))})
    });
    let accessors = all.iter().enumerate().map(|(i, (_, kind, count))| match *kind {
        "INDEX" => json!({"bufferView": i, "componentType": 5125, "count": count, "type": "SCALAR"}),
        "SCALAR" => json!({"bufferView": i, "componentType": 5126, "count": count, "type": kind, "min": [0], "max": [1]}),
        _ => json!({"bufferView": i, "componentType": 5126, "count": count, "type": kind}),
    });
    json!({
        "asset": {"version": "2.0"},
        "buffers": buffers.collect::<Vec<_>>(),
        "bufferViews": views.collect::<Vec<_>>(),
        "accessors": accessors.collect::<Vec<_>>(),
        "meshes": meshes,
        "nodes": nodes,
        "animations": [{"name": "pass", "channels": channels, "samplers": samplers}],
    })
}

/// Returns the numbers in single precision, as bytes.
fn floats(numbers: impl IntoIterator<Item = f64>) -> Vec<u8> {
    numbers.into_iter().flat_map(|x| (x as f32).to_le_bytes()).collect()
}
