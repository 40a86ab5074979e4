//! Nodes that a player does not show are left out, in scenes and for meshes at rest alike.

use glam::DVec3;

use super::file::{changed, positions, scene};
use crate::gltf::{AnimatedScene, SkinWeights, parse_placed_mesh, parse_scene};

/// A change of node 4, which hides it.
const HIDDEN: (&str, &str) =
    (r#"{"mesh":0,"scale""#, r#"{"mesh":0,"extensions":{"KHR_node_visibility":{"visible":false}},"scale""#);

/// A change that gives the file scenes.
fn with_scenes(scenes: &str) -> (&'static str, String) {
    (r#""nodes":["#, format!(r#"{scenes},"nodes":["#))
}

/// A change that gives the animation a channel of a JSON pointer.
fn with_pointer(pointer: &str) -> (&'static str, String) {
    (r#""extensions":{}"#, format!(r#""extensions":{{"KHR_animation_pointer":{{"pointer":{pointer}}}}}"#))
}

/// Returns the nodes of the changed file that show its mesh, which are those of the mesh at rest, and the notes.
fn shown(changes: &[(&str, &str)]) -> (Vec<usize>, Vec<String>) {
    let bytes = changed(changes);
    let (scene, placed) = (parse_scene(&bytes).unwrap(), parse_placed_mesh(&bytes, None).unwrap());
    let nodes: Vec<usize> = scene.mesh_nodes().iter().map(|mesh_node| mesh_node.node()).collect();
    let places: Vec<usize> = (0..placed.places()).filter_map(|place| placed.node(place)).collect();
    assert_eq!(nodes, places, "{changes:?}");
    (nodes, scene.notes().to_vec())
}

#[test]
fn nodes_outside_the_default_scene_are_left_out_with_a_note() {
    let none = "players show none of its meshes, so all nodes with a mesh count: these are hidden, or outside scene 0";
    for (scenes, nodes, notes) in [
        (
            r#""scenes":[{"nodes":[4]},{"nodes":[0,3]}]"#,
            &[4][..],
            &["1 node outside scene 0 is left out"][..],
        ),
        (
            r#""scenes":[{"nodes":[4]},{"nodes":[0,3]}],"scene":1"#,
            &[3],
            &["1 node outside scene 1 is left out"],
        ),
        (r#""scenes":[{"nodes":[4]}],"scene":null"#, &[4], &["1 node outside scene 0 is left out"]),
        (r#""scenes":[{"nodes":[3,4]}]"#, &[3, 4], &[]),
        // Scenes without meshes, or that do not exist.
        (r#""scenes":[{"nodes":[0]},{"nodes":[3,4]}]"#, &[3, 4], &[none]),
        (r#""scenes":[{"nodes":[4]}],"scene":7"#, &[3, 4], &[]),
        (r#""scenes":[]"#, &[3, 4], &[]),
    ] {
        let (from, to) = with_scenes(scenes);
        let notes: Vec<String> = notes.iter().map(|note| (*note).to_owned()).collect();
        assert_eq!(shown(&[(from, to.as_str())]), (nodes.to_vec(), notes), "{scenes}");
    }
}

#[test]
fn joints_and_ancestors_outside_the_scene_move_its_meshes() {
    let below = (r#""children":[1]"#, r#""children":[1,4]"#);
    for (node, scenes) in [(3, r#""scenes":[{"nodes":[3]}]"#), (4, r#""scenes":[{"nodes":[4]}]"#)] {
        let (from, to) = with_scenes(scenes);
        let (one, all) = (scene(&[below, (from, to.as_str())]), scene(&[below]));
        assert_eq!(one.mesh_nodes().iter().map(|found| found.node()).collect::<Vec<_>>(), [node]);
        for time in [None, Some(1.0), Some(1.7), Some(3.0)] {
            assert_eq!(positions(&one, node, time), positions(&all, node, time));
        }
    }
}

#[test]
fn hidden_nodes_and_all_below_them_are_left_out_with_a_note() {
    let note = "1 node that KHR_node_visibility hides is left out".to_owned();
    assert_eq!(shown(&[HIDDEN]), (vec![3], vec![note.clone()]));
    // The nodes of joints do not show the mesh of a skin.
    let root =
        (r#""name":"root","#, r#""name":"root","extensions":{"KHR_node_visibility":{"visible":false}},"#);
    let below = (r#""children":[1]"#, r#""children":[1,4]"#);
    assert_eq!(shown(&[root, below]), (vec![3], vec![note]));
    assert_eq!(shown(&[root]), (vec![3, 4], vec![]));
    for visible in [r#"{"visible":true}"#, r#"{"visible":null}"#, "{}", "null"] {
        let visible = HIDDEN.1.replace(r#"{"visible":false}"#, visible);
        assert_eq!(shown(&[(HIDDEN.0, visible.as_str())]), (vec![3, 4], vec![]), "{visible}");
    }
    // A node outside of the scene is counted once.
    let (from, to) = with_scenes(r#""scenes":[{"nodes":[3]}]"#);
    let outside = "1 node outside scene 0 is left out".to_owned();
    assert_eq!(shown(&[HIDDEN, (from, to.as_str())]), (vec![3], vec![outside]));
}

#[test]
fn hidden_nodes_that_an_animation_can_show_count_as_shown_with_a_note() {
    let note = "1 node that KHR_node_visibility hides is treated as shown at all times: an animation can change that, and it \
                is not evaluated";
    let found = |pointer: &str| {
        let (from, to) = with_pointer(pointer);
        shown(&[HIDDEN, (from, to.as_str())])
    };
    let switched = (vec![3, 4], vec![note.to_owned()]);
    assert_eq!(found(r#""/nodes/4/extensions/KHR_node_visibility/visible""#), switched);
    // A malformed pointer may be that of any node.
    assert_eq!(found("5"), switched);
    for other in ["/nodes/3/extensions/KHR_node_visibility/visible", "/nodes/4/translation", "/nodes/4"] {
        assert_eq!(found(&format!(r#""{other}""#)).0, [3], "{other}");
    }
    // The root stays hidden, and with it the node below.
    let root =
        (r#""name":"root","#, r#""name":"root","extensions":{"KHR_node_visibility":{"visible":false}},"#);
    let below = (r#""children":[1]"#, r#""children":[1,4]"#);
    let (from, to) = with_pointer(r#""/nodes/4/extensions/KHR_node_visibility/visible""#);
    assert_eq!(shown(&[HIDDEN, root, below, (from, to.as_str())]).0, [3]);
    let (from, to) = with_pointer(r#""/nodes/0/extensions/KHR_node_visibility/visible""#);
    assert_eq!(shown(&[root, below, (from, to.as_str())]), switched);
}

#[test]
fn left_out_nodes_are_found_by_number_or_name() {
    let (from, to) = with_scenes(r#""scenes":[{"nodes":[4]}]"#);
    let some = scene(&[(from, to.as_str())]);
    let found = |node: &str| some.find_mesh_nodes(Some(node)).unwrap()[0].node();
    assert_eq!((found("3"), found("skinned"), found("4")), (3, 3, 4));
    assert_eq!(some.find_mesh_nodes(None).unwrap().len(), 1);
    let message = some.find_mesh_nodes(Some("skin")).unwrap_err().to_string();
    assert_eq!(message, "no node 'skin' shows a mesh with triangles; these nodes do: 4, 3 'skinned'");
    assert_eq!(positions(&some, 3, Some(1.5)), positions(&scene(&[]), 3, Some(1.5)));
    // A shown node is preferred to another one of the same name.
    let named = scene(&[(from, to.as_str()), (r#""weights":[0.5]"#, r#""name":"skinned""#)]);
    assert_eq!(named.find_mesh_nodes(Some("skinned")).unwrap()[0].node(), 4);
}

/// Returns the positions of a node, and whether it is flattened, in three ways, which must agree to the last bit.
fn positions_of_poses(scene: &AnimatedScene, node: usize, time: Option<f64>) -> Vec<DVec3> {
    let animation = time.map(|_| 0);
    let time = time.unwrap_or(0.0);
    let whole = scene.pose(animation, time).unwrap();
    let poses = [scene.pose_of(whole.state()), scene.pose_of_node(node, animation, time).unwrap(), whole];
    let found = poses.map(|pose| {
        let mut positions = Vec::new();
        pose.positions(node, SkinWeights::Normalized, &mut positions).unwrap();
        (positions, pose.is_flattened(node))
    });
    let [first, second, third] = found;
    assert!(first == second && second == third);
    first.0
}

#[test]
fn poses_of_one_node_and_of_shared_states_are_those_of_the_scene() {
    let below = (r#""children":[1]"#, r#""children":[1,4]"#);
    let scene = scene(&[below]);
    for time in [None, Some(0.0), Some(1.3), Some(2.0), Some(3.1), Some(9.0)] {
        for node in [3, 4] {
            assert_eq!(positions_of_poses(&scene, node, time).len(), 4);
        }
    }
    // The pose of one node has no positions of another one.
    let other = scene.pose_of_node(4, Some(0), 1.3).unwrap();
    let refused = other.positions(3, SkinWeights::Normalized, &mut Vec::new()).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "nodes[3]: the position of vertex 0 (counted from 0) is not finite, or beyond 2^200"
    );
    // Five transforms, and the weights of two nodes.
    assert!(scene.state_size() >= 5 * 128 + 2 * 8, "{}", scene.state_size());
}
