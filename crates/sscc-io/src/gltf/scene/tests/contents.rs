//! Lists of the contents of a file.

use super::file::{JSON, binary, changed, glb};
use crate::gltf::{Contents, NamedPart, parse_contents, parse_scene};

fn contents(changes: &[(&str, &str)]) -> Contents {
    parse_contents(&changed(changes)).unwrap()
}

fn named(name: Option<&str>, parts: usize) -> NamedPart {
    NamedPart { name: name.map(str::to_owned), parts }
}

#[test]
fn every_part_is_listed_once() {
    let scenes = r#""scenes":[{"nodes":[4]},{"name":"main","nodes":[0,3]}],"scene":1,"nodes":["#;
    let contents = contents(&[(r#""nodes":["#, scenes), (r#""skins":[{"#, r#""skins":[{"name":"arm","#)]);
    assert_eq!(contents.scenes, [named(None, 1), named(Some("main"), 2)]);
    assert_eq!((contents.default_scene, contents.nodes), (Some(1), 5));
    let nodes: Vec<_> = contents
        .mesh_nodes
        .iter()
        .map(|n| (n.node, n.name.as_deref(), n.mesh, n.skin, n.is_in_default_scene))
        .collect();
    assert_eq!(nodes, [(3, Some("skinned"), 0, Some(0), true), (4, None, 0, None, false)]);
    let [mesh] = &contents.meshes[..] else { panic!() };
    assert_eq!((mesh.name.as_str(), mesh.primitives, &mesh.size), ("flag", 2, &Ok([2, 4])));
    assert_eq!((&mesh.targets[..], &mesh.default_weights[..]), (&["target 0".to_owned()][..], &[0.0][..]));
    assert_eq!(contents.skins, [named(Some("arm"), 2)]);
    let [animation] = &contents.animations[..] else { panic!() };
    assert_eq!(animation.error, None);
    assert_eq!([&animation.info], [&parse_scene(&glb(JSON, &binary())).unwrap().animations()[0]]);
}

#[test]
fn malformed_parts_have_their_errors() {
    // The indices of the accessor of positions, and the times of key frames.
    let broken = contents(&[
        (r#"{"bufferView":0,"componentType":5126"#, r#"{"bufferView":0,"componentType":5125"#),
        (r#""input":5,"output":6"#, r#""input":77,"output":6"#),
    ]);
    let error = broken.meshes[0].size.as_ref().unwrap_err().to_string();
    assert!(error.starts_with("accessors[0]: "), "{error}");
    let error = broken.animations[0].error.as_ref().unwrap().to_string();
    assert_eq!(error, "accessors[77]: there is no such accessor");
    assert_eq!(broken.animations[0].info.name.as_deref(), Some("wave"));
    // If a buffer is missing, the rest of the list is complete.
    let missing = JSON.replace(r#"{"byteLength":512}"#, r#"{"byteLength":512,"uri":"missing.bin"}"#);
    let missing = parse_contents(missing.as_bytes()).unwrap();
    assert!(missing.meshes[0].size.is_err() && missing.animations[0].error.is_some());
    assert_eq!((missing.skins.len(), missing.mesh_nodes.len()), (1, 2));
    assert!(parse_contents(&changed(&[(r#""children":[1]"#, r#""children":[9]"#)])).is_err());
}

#[test]
fn files_without_triangles_are_listed() {
    let points = contents(&[(r#""mode":5"#, r#""mode":0"#)]);
    assert_eq!(points.meshes[0].size, Ok([0, 0]));
    let cameras = br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"camera":0}],
        "cameras":[{"type":"perspective"}]}"#;
    let cameras = parse_contents(cameras).unwrap();
    assert_eq!((cameras.default_scene, cameras.nodes, cameras.scenes), (Some(0), 1, vec![named(None, 1)]));
    assert!(cameras.meshes.is_empty() && cameras.mesh_nodes.is_empty() && cameras.skins.is_empty());
}
