//! `sscc info` of glTF files, and of meshes whose vertices are split.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use sscc_testing::models;

use crate::common::sscc;

fn info(folder: &Path, file: &str) -> Value {
    let run = sscc(folder, &["info", file, "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    run.json().remove(0)
}

fn text(folder: &Path, file: &str) -> String {
    let run = sscc(folder, &["info", file]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    run.stdout
}

#[test]
fn a_published_character() {
    let Some(models) = models("a_published_character") else { return };
    let robot = info(&models, "skinned/RobotExpressive.glb");
    assert_eq!(robot["scenes"], json!([{"name": "Root Scene", "root_nodes": 1}]));
    let count = |part: &str| robot[part].as_array().unwrap().len();
    assert_eq!(["nodes", "meshes", "skins", "animations"].map(count), [14, 14, 2, 14]);
    assert_eq!(
        (&robot["meshes"][2]["triangles"], &robot["meshes"][2]["vertices"], &robot["meshes"][2]["targets"]),
        (&json!(810), &json!(1742), &json!(["Angry", "Surprised", "Sad"]))
    );
    assert!(robot["meshes"].as_array().unwrap().iter().all(|mesh| mesh["triangles"].as_u64().unwrap() > 0));
    assert_eq!(robot["skins"][0], json!({"name": null, "joints": 43}));
    assert_eq!(robot["animations"][0]["name"], "Dance");
    let seconds = robot["animations"][0]["seconds"].as_f64().unwrap();
    assert!((3.0..4.0).contains(&seconds), "{seconds}");

    let text = text(&models, "skinned/RobotExpressive.glb");
    assert!(
        text.starts_with(
            "glTF           1 scene, 74 nodes (14 with meshes), 14 meshes, 2 skins, 14 animations\n"
        ),
        "{text}"
    );
    for part in ["Foot.L", "Dance", "Angry", "Root Scene"] {
        let lines = text
            .lines()
            .filter(|line| line.split_whitespace().any(|word| word == part) || line.ends_with(part));
        // Names of meshes are also names of their nodes.
        let expected = if part == "Foot.L" { 2 } else { 1 };
        assert!(
            part == "Root Scene" && text.matches(part).count() == 1 || lines.count() == expected,
            "{part}: {text}"
        );
    }
    assert!(text.contains("\n   2        810     1,742        3  Head\n"), "{text}");
    assert!(text.contains("\ntargets of mesh 2 (Head)\n  0 Angry        1 Surprised    2 Sad\n"), "{text}");
}

#[test]
fn parts_that_cannot_be_checked() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let write = |name: &str, file: Value| fs::write(folder.join(name), file.to_string()).unwrap();
    write(
        "cameras.gltf",
        json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"camera": 0}]}),
    );
    let cameras = text(folder, "cameras.gltf");
    assert!(
        cameras.starts_with(
            "glTF           1 scene, 1 node (0 with meshes), 0 meshes, 0 skins, 0 animations\n\
             no triangles   no mesh has any: export the scene with its surfaces\n"
        ),
        "{cameras}"
    );
    // Points, a mesh in a missing file, and names that occur twice.
    let points = json!({"name": "a\nb", "primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]});
    let lost = json!({"name": "a\nb", "primitives": [{"attributes": {"POSITION": 0}}]});
    write(
        "lost.gltf",
        json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 36, "uri": "lost.bin"}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "meshes": [points, lost, {"primitives": []}], "nodes": [{"mesh": 1}, {"mesh": 7}], "scenes": [{}],
            "animations": [{"name": "run", "channels": [], "samplers": []},
                {"name": "run", "channels": [], "samplers": []}]}),
    );
    let lost = info(folder, "lost.gltf");
    assert_eq!((&lost["meshes"][0]["triangles"], &lost["meshes"][1]["triangles"]), (&json!(0), &Value::Null));
    let error = lost["meshes"][1]["error"].as_str().unwrap();
    assert!(error.starts_with("buffers[0]: ") && error.ends_with("lost.bin: not found"), "{error}");
    let text = text(folder, "lost.gltf");
    for line in [
        "   0          0         0        0  a\\nb (points and lines only)\n",
        "   1          -         -        0  a\\nb (malformed: buffers[0]: ",
        "   2          0         0        0  #2 (points and lines only)\n",
        "   0     1     -  - (not in the default scene)\n",
        "   1     7     -  - (malformed: there is no such mesh)\n",
        "\nseveral meshes have the name a\\nb: choose one by its number, as in --mesh-name 0\n",
        "\nseveral animations have the name run: choose one by its number, as in --animation 0\n",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let refused = sscc(folder, &["info", "missing.glb"]);
    assert!(refused.refusal().ends_with("missing.glb: not found"), "{refused:?}");
}

/// A closed tetrahedron whose corners are not shared; its first `count` faces.
fn soup(count: usize) -> Vec<[&'static str; 3]> {
    let [o, x, y, z] = ["0 0 0", "1 0 0", "0 1 0", "-0 0 1"];
    [[o, y, x], [o, x, z], [x, y, z], [o, z, y]].into_iter().take(count).collect()
}

fn stl(faces: &[[&str; 3]]) -> String {
    let facet = |[a, b, c]: &[&str; 3]| {
        format!("facet\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
    };
    format!("solid\n{}endsolid\n", faces.iter().map(facet).collect::<String>())
}

#[test]
fn info_states_whether_a_mesh_is_closed_after_welding() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let obj: String = soup(4).as_flattened().iter().map(|corner| format!("v {corner}\n")).collect();
    fs::write(folder.join("soup.obj"), obj + "f 1 2 3\nf 4 5 6\nf 7 8 9\nf 10 11 12\n").unwrap();
    fs::write(folder.join("closed.stl"), stl(&soup(4))).unwrap();
    fs::write(folder.join("open.stl"), stl(&soup(3))).unwrap();
    // A sliver between two equal corners, and a fin at an edge.
    let more = [["0 0 0", "0 0 0", "1 0 0"], ["0 0 0", "1 0 0", "0 -1 -1"]];
    fs::write(folder.join("fin.stl"), stl(&[soup(4), more.to_vec()].concat())).unwrap();
    for (file, form) in [
        (
            "closed.stl",
            "4 triangles, 12 vertices (12 used), with equal corners welded 4 vertices, closed, manifold",
        ),
        (
            "open.stl",
            "3 triangles, 9 vertices (9 used), with equal corners welded 4 vertices, open (3 boundary edges), manifold",
        ),
        (
            "fin.stl",
            "6 triangles, 18 vertices (18 used), with equal corners welded 5 vertices, open (2 boundary edges), 1 edge of more \
             than two triangles",
        ),
        (
            "soup.obj",
            "4 triangles, 12 vertices (12 used), open (12 boundary edges), manifold; with equal corners welded 4 vertices, \
             closed, manifold",
        ),
    ] {
        let text = text(folder, file);
        assert!(text.starts_with(&format!("mesh           {form}\n")), "{file}: {text}");
    }
    let welded = json!({"vertices": 4, "boundary_edges": 0, "non_manifold_edges": 0});
    for file in ["closed.stl", "soup.obj"] {
        let info = info(folder, file);
        assert_eq!((&info["boundary_edges"], &info["welded"]), (&json!(12), &welded), "{file}");
    }
}
