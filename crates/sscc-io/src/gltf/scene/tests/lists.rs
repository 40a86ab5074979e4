//! Nodes with a mesh, animations and weld classes.

use glam::DVec3;

use super::file::{JSON, REST, binary, changed, glb, positions, scene};
use crate::gltf::{AnimationInfo, parse_placed_mesh, parse_scene};

#[test]
fn nodes_and_animations_are_listed() {
    let scene = scene(&[]);
    let [skinned, rigid] = scene.mesh_nodes() else { panic!() };
    assert_eq!((skinned.node(), skinned.name(), skinned.skin()), (3, Some("skinned"), Some(0)));
    assert_eq!((rigid.node(), rigid.name(), rigid.is_skinned()), (4, None, false));
    for node in [skinned, rigid] {
        assert_eq!((node.mesh(), node.mesh_name(), node.morph_targets()), (0, Some("flag"), 1));
        assert_eq!(node.faces(), [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(node.rest_positions(), REST.map(|x| DVec3::from_array(x.map(f64::from))));
        assert_eq!(node.largest_weight_error(), 0.0);
        // Order and zeros of influences do not count, nor the sign of zero.
        assert_eq!(node.weld_classes(), [0, 1, 2, 2]);
    }
    let info = AnimationInfo {
        name: Some("wave".into()),
        first_time: 1.0,
        last_time: 4.0,
        channels: 4,
        extension_channels: 1,
    };
    assert_eq!(scene.animations(), [info]);
    fn is_shared<T: Send + Sync>(_: &T) -> bool {
        true
    }
    assert!(is_shared(&scene));
}

#[test]
fn influences_separate_classes_of_skinned_nodes_alone() {
    let mut binary = binary();
    binary[112 + 2 * 16..][..4].copy_from_slice(&0.5_f32.to_le_bytes());
    let scene = parse_scene(&glb(JSON, &binary)).unwrap();
    let [skinned, rigid] = scene.mesh_nodes() else { panic!() };
    assert_eq!((skinned.weld_classes(), rigid.weld_classes()), (&[0, 1, 2, 3][..], &[0, 1, 2, 2][..]));
    assert_eq!((skinned.largest_weight_error(), rigid.largest_weight_error()), (0.25, 0.0));
}

#[test]
fn unusual_files_are_read() {
    let flat = scene(&[(r#""scale":[-1,1,1]"#, r#""scale":[0,0,0]"#)]);
    assert_eq!(positions(&flat, 4, None), [DVec3::new(0.0, 0.0, 5.0); 4]);
    assert!(scene(&[(r#""mode":5"#, r#""mode":0"#)]).mesh_nodes().is_empty());
    let none = parse_scene(br#"{"asset":{"version":"2.0"}}"#).unwrap();
    assert!(none.mesh_nodes().is_empty() && none.animations().is_empty());
    // Channels of extensions are counted, but not evaluated.
    let json = JSON.replace(r#""node":3,"#, "").replace(r#""mesh":0,"#, "");
    let unused = parse_scene(&glb(&json, &binary())).unwrap();
    let info = &unused.animations()[0];
    assert_eq!((unused.mesh_nodes().len(), info.channels, info.extension_channels), (0, 3, 2));
}

/// The indices of the strip are the numbers of the joints, which are 0 and 1.
#[test]
fn nodes_whose_strips_have_no_triangles_are_left_out_with_a_note() {
    let indices = r#""type":"SCALAR"},{"bufferView":2,"componentType":5121,"count":16,"type":"SCALAR"}]"#;
    let changes = [(r#""mode":5"#, r#""mode":5,"indices":10"#), (r#""type":"SCALAR"}]"#, indices)];
    let scene = scene(&changes);
    assert!(scene.mesh_nodes().is_empty());
    let note = |node: u32| {
        format!(
            "nodes[{node}]: meshes[0] has only strips whose triangles have repeated corners, so it has no triangles; the node \
             is left out"
        )
    };
    assert_eq!(scene.notes(), [note(3), note(4)]);
    let message = scene.find_mesh_nodes(None).unwrap_err().to_string();
    assert_eq!(message, "no node of the file shows a mesh with triangles");
    // The mesh alone has an error with its number.
    let mesh = parse_placed_mesh(&changed(&changes), None).unwrap();
    let message = mesh.to_mesh(0).unwrap_err().to_string();
    assert!(message.starts_with("meshes[0]: it has only strips whose triangles have repeated"), "{message}");
}

#[test]
fn animations_and_nodes_are_found_by_name_or_number() {
    let scene = scene(&[]);
    assert_eq!((scene.find_animation("wave"), scene.find_animation("0")), (Ok(0), Ok(0)));
    let message = scene.find_animation("1").unwrap_err().to_string();
    assert_eq!(message, "there is no animation '1'; the animations of the file, by number: 0 'wave'");
    assert_eq!(scene.find_mesh_nodes(None).unwrap().len(), 2);
    assert_eq!(scene.find_mesh_nodes(Some("4")).unwrap()[0].node(), 4);
    assert_eq!(scene.find_mesh_nodes(Some("skinned")).unwrap()[0].node(), 3);
    let message = scene.find_mesh_nodes(Some("skin")).unwrap_err().to_string();
    assert_eq!(message, "no node 'skin' shows a mesh with triangles; these nodes do: 3 'skinned', 4");
    let message = scene.find_mesh_nodes(Some("0")).unwrap_err().to_string();
    assert_eq!(message, "node 0 shows no mesh with triangles; these nodes do: 3 'skinned', 4");
    let none = parse_scene(
        br#"{"asset":{"version":"2.0"},"animations":[
        {"name":"0","channels":[],"samplers":[]},{"name":"a","channels":[],"samplers":[]},
        {"name":"a","channels":[],"samplers":[]}]}"#,
    );
    let none = none.unwrap();
    let message = |name| none.find_animation(name).unwrap_err().to_string();
    assert_eq!(
        message("a"),
        "2 animations have the name 'a': choose one by its number; the animations of the file, by number: 0 '0', 1 'a', 2 'a'"
    );
    // A name is preferred to a number. Animations without key frames cannot be evaluated.
    assert_eq!(message("0"), "animations[0]: it has no key frames");
    let message = none.find_mesh_nodes(None).unwrap_err().to_string();
    assert_eq!(message, "no node of the file shows a mesh with triangles");
    let empty = parse_scene(br#"{"asset":{"version":"2.0"}}"#).unwrap();
    assert_eq!(empty.find_animation("0").unwrap_err().to_string(), "the file has no animations");
}
