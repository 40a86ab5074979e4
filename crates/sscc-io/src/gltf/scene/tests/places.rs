//! Meshes at rest are at the places that nodes give them.

use glam::{DMat4, DQuat, DVec3};

use super::file::{JSON, REST, assert_close, binary, changed, glb, skinned};
use crate::gltf::{PlacedMesh, read_model_placement, read_placed_mesh};
use crate::{GroupsBy, load_mesh};

/// Reads the mesh of a name from a file of these bytes.
fn placed(bytes: &[u8], name: Option<&str>) -> Result<PlacedMesh, String> {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("flag.glb");
    std::fs::write(&path, bytes).unwrap();
    let read = read_placed_mesh(&path, name).map_err(|error| error.to_string());
    if let Ok(read) = &read {
        let first = load_mesh(&path, name).unwrap();
        assert_eq!((first.faces(), first.rest_positions()), (read.faces(), &at(read, 0)[..]));
        let model = read_model_placement(&path, None).unwrap();
        assert_eq!(model.mesh(), read.mesh());
    }
    read.map_err(|error| error.rsplit("flag.glb: ").next().unwrap().to_owned())
}

fn at(placed: &PlacedMesh, place: usize) -> Vec<DVec3> {
    let mesh = placed.to_mesh(place).unwrap();
    assert_eq!(mesh.faces(), placed.faces());
    mesh.rest_positions().to_vec()
}

fn nodes(placed: &PlacedMesh) -> Vec<Option<usize>> {
    (0..placed.places()).map(|place| placed.node(place)).collect()
}

/// The file with these scenes in place of its animations.
fn with_scenes(scenes: &str) -> Vec<u8> {
    glb(&(JSON[..JSON.find("\"animations\"").unwrap()].to_owned() + scenes + "}"), &binary())
}

#[test]
fn each_node_is_a_place() {
    for name in [None, Some("flag"), Some("#0"), Some("0")] {
        let flag = placed(&changed(&[]), name).unwrap();
        assert_eq!(flag.faces(), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(flag.rest_positions(), REST.map(|x| DVec3::from_array(x.map(f64::from))));
        assert_eq!((nodes(&flag), flag.mesh()), (vec![Some(3), Some(4)], 0));
        // The transform of a node with a skin has no effect; the weights of morph targets have none at rest.
        let joints = skinned(10.0, DQuat::from_xyzw(0.0, 0.0, 1.0, 0.0), DVec3::new(1.0, 2.0, 1.0), 0.0);
        assert_close(&at(&flag, 0), &joints);
        let mirrored = [[0.0, 0.0, 5.0], [-1.0, 0.0, 5.0], [0.0, 1.0, 5.0], [0.0, 1.0, 5.0]];
        assert_eq!(at(&flag, 1), mirrored.map(DVec3::from_array));
        assert_eq!((flag.skin(0), flag.skin(1), flag.transform(0)), (Some(0), None, None));
        assert!(!flag.is_flattened(0) && !flag.is_flattened(1));
        assert_eq!(flag.groups(1, GroupsBy::Object).unwrap().names, ["#4"]);
    }
    let message = placed(&changed(&[]), Some("pole")).err().unwrap();
    assert_eq!(message, "there is no mesh 'pole'; meshes with triangles: 'flag'");
    let lines = placed(&changed(&[(r#""mode":5"#, r#""mode":1"#)]), None).err().unwrap();
    assert_eq!(lines, "no mesh of the file has triangles: export the scene with its surfaces");
}

#[test]
fn a_node_can_be_named() {
    let one = placed(&changed(&[]), Some("skinned")).unwrap();
    assert_eq!(nodes(&one), [Some(3)]);
    assert_eq!(one.groups(0, GroupsBy::Object).unwrap().names, ["skinned"]);
    // The name of a mesh is preferred to that of a node; a node without triangles does not count.
    let node = r#"{"name":"skinned","mesh":0"#;
    let both = placed(&changed(&[(node, r#"{"name":"flag","mesh":0"#)]), Some("flag")).unwrap();
    assert_eq!(nodes(&both), [Some(3), Some(4)]);
    assert!(placed(&changed(&[]), Some("root")).err().unwrap().starts_with("there is no mesh 'root'"));
    let two = changed(&[(r#""weights":[0.5]"#, r#""name":"skinned""#)]);
    let message = placed(&two, Some("skinned")).err().unwrap();
    assert_eq!(
        message,
        "2 nodes with a mesh have the name 'skinned': choose the mesh, by its name or number"
    );
}

#[test]
fn the_default_scene_is_preferred() {
    for (scenes, expected) in [
        (r#""scenes":[{"nodes":[0,3]},{"nodes":[4]}]"#, &[Some(3)][..]),
        (r#""scenes":[{"nodes":[0,3]},{"nodes":[4]}],"scene":1"#, &[Some(4)]),
        // Scenes without the mesh, or that do not exist.
        (r#""scenes":[{"nodes":[0]}],"scene":0"#, &[Some(3), Some(4)]),
        (r#""scenes":[{"nodes":[4]}],"scene":7"#, &[Some(3), Some(4)]),
        (r#""scenes":[{}],"scene":null"#, &[Some(3), Some(4)]),
        (r#""scenes":[{"nodes":[99,4,4]}]"#, &[Some(4)]),
        (r#""scenes":[]"#, &[Some(3), Some(4)]),
    ] {
        assert_eq!(nodes(&placed(&with_scenes(scenes), None).unwrap()), expected, "{scenes}");
    }
    // A node below a root is in its scene.
    let json =
        JSON[..JSON.find("\"animations\"").unwrap()].replace(r#""children":[1]"#, r#""children":[1,4]"#);
    let below = placed(&glb(&(json + r#""scenes":[{"nodes":[0]}]}"#), &binary()), None).unwrap();
    assert_eq!(nodes(&below), [Some(4)]);
    assert_eq!(at(&below, 0)[1], DVec3::new(-1.0, 0.0, 15.0));
}

#[test]
fn a_mesh_without_nodes_keeps_its_own_coordinates() {
    let json = JSON.replace(r#""mesh":0,"#, "");
    let own = placed(&glb(&json, &binary()), None).unwrap();
    assert_eq!((nodes(&own), own.transform(0)), (vec![None], Some(DMat4::IDENTITY)));
    assert_eq!(at(&own, 0), own.rest_positions());
    assert_eq!(own.groups(0, GroupsBy::Object).unwrap().names, ["flag"]);
}

#[test]
fn flat_places_are_reported_and_invalid_ones_are_rejected() {
    let flat = placed(&changed(&[(r#""scale":[-1,1,1]"#, r#""scale":[1,0,1]"#)]), None).unwrap();
    assert!(flat.is_flattened(1) && !flat.is_flattened(0));
    let far = placed(&changed(&[(r#""scale":[-1,1,1]"#, r#""scale":[1e300,1,1]"#)]), None).unwrap();
    let message = far.to_mesh(1).unwrap_err().to_string();
    assert_eq!(message, "nodes[4]: the position of vertex 1 (counted from 0) is not finite, or beyond 2^200");
    assert!(far.place(2, &mut [DVec3::ZERO; 4]).is_err() && far.place(0, &mut [DVec3::ZERO; 3]).is_err());
    for (from, to, message) in [
        (
            r#""joints":[1,2]"#,
            r#""joints":[1]"#,
            "nodes[3]: vertex 1 (counted from 0) of meshes[0] names joint 1, but",
        ),
        (r#""mesh":0,"skin":0"#, r#""mesh":0,"skin":1"#, "nodes[3]: skins[1] does not exist"),
        (r#""children":[2]"#, r#""children":[1]"#, "nodes[1]: it is a child of nodes[0] and of nodes[1]"),
    ] {
        let found = placed(&changed(&[(from, to)]), None).err().unwrap();
        assert!(found.starts_with(message), "{found}");
    }
}

/// Integer positions, scaled by a node, as quantizing exporters write them.
#[test]
fn nodes_scale_integer_positions() {
    let mut binary = binary();
    for (at, number) in [0_i16, 0, 0, 400, 0, 0, 0, 400, 0, 0, 400, 0].iter().enumerate() {
        binary[2 * at..][..2].copy_from_slice(&number.to_le_bytes());
    }
    let json =
        JSON.replacen(r#""componentType":5126,"count":4"#, r#""componentType":5122,"count":4"#, 1).replace(
            r#""scale":[-1,1,1],"translation":[0,0,5]"#,
            r#""scale":[0.01,0.01,0.01],"translation":[0.9,1,-1.1]"#,
        );
    let quantized = placed(&glb(&json, &binary), None).unwrap();
    assert_eq!(quantized.rest_positions()[1], DVec3::new(400.0, 0.0, 0.0));
    assert_eq!(at(&quantized, 1)[1], DVec3::new(0.01 * 400.0 + 0.9, 1.0, -1.1));
}
