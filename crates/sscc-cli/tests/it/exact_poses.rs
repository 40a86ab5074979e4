//! Rigid parts of an animation that touch exactly at rest: the pairs are those that touch in exact arithmetic, on the
//! positions that the command writes.

use std::fs;
use std::path::Path;

use glam::DVec3;
use serde_json::json;
use sscc::MovingTriangle;
use sscc_io::read_mesh;
use sscc_testing::distance;

use crate::common::sscc;
use crate::places::{Corners, gltf};

/// The triangles of an axis-parallel box.
fn brick(low: [f32; 3], high: [f32; 3]) -> Corners {
    let corner = |bits: usize| [0, 1, 2].map(|k| if bits >> k & 1 == 0 { low[k] } else { high[k] });
    let square = |a, b, c, d| [a, b, c, a, c, d].map(corner);
    let sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)];
    sides.into_iter().flat_map(|(a, b, c, d)| square(a, b, c, d)).collect()
}

/// Whether the AABBs of two triangles are disjoint.
fn is_apart(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let bounds = |t: &[DVec3; 3]| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let ((a_min, a_max), (b_min, b_max)) = (bounds(a), bounds(b));
    a_max.cmplt(b_min).any() || b_max.cmplt(a_min).any()
}

/// Two courses of bricks in a running bond: they touch along faces, and most touching pairs have no common vertex. Each is
/// a primitive of one mesh, which nested nodes rotate, scale and move.
fn wall() -> serde_json::Value {
    let bricks: Vec<Corners> = [(0.0, 0.0), (0.9, 0.0), (0.45, 0.3), (1.35, 0.3)]
        .into_iter()
        .map(|(x, z): (f32, f32)| brick([x, 0.1, z], [x + 0.9, 0.7, z + 0.3]))
        .collect();
    let times = [[0.0, 1.0, 3.0]];
    // Three quaternions of length 1 only up to single precision, in groups of three numbers.
    let turns = [[0.0, 0.0, 0.0], [1.0, 0.36, 0.48], [0.6, 0.529_15, -0.48], [0.0, 0.64, 0.6]];
    let named: Vec<(&str, &[[f32; 3]])> = bricks
        .iter()
        .map(|brick| ("brick", &brick[..]))
        .chain([("times", &times[..]), ("turns", &turns[..])])
        .collect();
    let nodes = json!([
        {"children": [1], "translation": [0.3, 17.1, -4.4], "rotation": [0.1, 0.2, 0.3, 0.9]},
        {"children": [2], "scale": [1.7, 0.31, 2.9]},
        {"mesh": 0, "translation": [-0.7, 0.1, 0.2]}]);
    let mut file = gltf(&named, nodes);
    let primitives: Vec<_> =
        (0..bricks.len()).map(|number| json!({"attributes": {"POSITION": number}})).collect();
    file["meshes"] = json!([{"name": "wall", "primitives": primitives}]);
    let scalar = |view: usize, count: usize, kind: &str| json!({"bufferView": view, "componentType": 5126, "count": count, "type": kind});
    file["accessors"][bricks.len()] = scalar(bricks.len(), 3, "SCALAR");
    file["accessors"][bricks.len() + 1] = scalar(bricks.len() + 1, 3, "VEC4");
    file["animations"] = json!([{"name": "turn",
        "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
        "samplers": [{"input": bricks.len(), "output": bricks.len() + 1}]}]);
    file
}

#[test]
fn pairs_that_touch_are_those_of_exact_arithmetic() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("wall.gltf"), wall().to_string()).unwrap();
    let (at_rest, rest) = at_rest(folder);
    let (mut touching, mut parted) = (0, 0);
    for time in ["0", "0.37", "1", "2.2"] {
        let time = format!("--times={time}");
        let check = |more: &[&str]| {
            let args = ["check", "wall.gltf", "--animation=turn", &time, "--json"];
            let run = sscc(folder, &[&args, more].concat());
            assert_eq!((run.code, run.stderr.as_str()), (Some(1), ""), "{run:?}");
            run.json()[0]["pairs"].clone()
        };
        let listed = check(&["--weld=off", "--pose=p.obj"]);
        let welded = check(&["--pose=p.ply"]);
        // Triangles are in the order of the mesh, and both formats have the same positions.
        let (pose, ply) =
            (read_mesh(&folder.join("p.obj")).unwrap(), read_mesh(&folder.join("p.ply")).unwrap());
        assert_eq!((pose.rest_positions(), pose.faces()), (ply.rest_positions(), ply.faces()));
        let corners = |positions: &[DVec3]| -> Vec<[DVec3; 3]> {
            pose.faces().iter().map(|face| face.map(|v| positions[v as usize])).collect()
        };
        let (triangles, stored) = (corners(pose.rest_positions()), corners(&rest));
        assert_eq!(triangles.len(), 48);
        let mut exact = Vec::new();
        for j in 0..triangles.len() {
            for i in 0..j {
                let [a, b] = [triangles[i], triangles[j]].map(|t| MovingTriangle { t0: t, t1: t });
                if !is_apart(&a.t0, &b.t0) && distance(&a, &b, 0.0) == 0.0 {
                    exact.push([i, j]);
                }
            }
        }
        exact.sort_unstable();
        assert_eq!(listed, json!(exact), "{time}");
        touching += exact.len();
        parted += usize::from(exact.len() < at_rest);
        exact.retain(|[i, j]| !stored[*i].iter().any(|corner| stored[*j].contains(corner)));
        assert_eq!(welded, json!(exact), "{time}");
    }
    // The test is about rounding: in some frames, faces that touch at rest have parted.
    assert!(touching > 400 && parted > 0, "{touching} {parted}");
}

/// Returns the number of pairs that touch in the stored positions, and these positions.
fn at_rest(folder: &Path) -> (usize, Vec<DVec3>) {
    let mut still = wall();
    still["nodes"] = json!([{"mesh": 0}]);
    still["animations"] = json!([]);
    fs::write(folder.join("still.gltf"), still.to_string()).unwrap();
    let run = sscc(folder, &["check", "still.gltf", "--weld=off", "--json", "--pose=still.ply"]);
    let rest = read_mesh(&folder.join("still.ply")).unwrap().rest_positions().to_vec();
    (run.json()[0]["count"].as_u64().unwrap() as usize, rest)
}
