//! Poses of a whole scene, of one node and of shared states are the same.

use glam::DVec3;

use super::file::scene;
use crate::gltf::{AnimatedScene, SkinWeights};

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
