//! The states of a scene at the times of its queries: all nodes of a file share them.

use std::sync::{Arc, OnceLock};

use sscc_io::FormatError;
use sscc_io::gltf::{AnimatedScene, ScenePose, SceneState};

/// Maximum memory of the states that are kept (bytes), as for meshes of a folder of frames. The state of a node takes about 128
/// bytes at each time.
const MAX_KEPT: u64 = 1 << 30;

/// A scene at given times. Where the states of all times fit into memory, each is evaluated once for all nodes. Else each node
/// evaluates only what it needs, so that no query costs as much as the whole scene.
pub(super) struct ScenePoses {
    scene: Arc<AnimatedScene>,
    /// Number of the animation; None means the scene as it is stored.
    animation: Option<usize>,
    times: Vec<f64>,
    /// The state at each time; empty if states are not kept.
    kept: Vec<OnceLock<Arc<SceneState>>>,
}

impl ScenePoses {
    /// Creates the poses of a scene at times, at least one, for queries of this number of nodes.
    pub fn new(scene: Arc<AnimatedScene>, animation: Option<usize>, times: Vec<f64>, nodes: usize) -> Self {
        Self::with_memory(scene, animation, times, nodes, MAX_KEPT)
    }

    fn with_memory(
        scene: Arc<AnimatedScene>,
        animation: Option<usize>,
        times: Vec<f64>,
        nodes: usize,
        memory: u64,
    ) -> Self {
        // A single node needs each state once or twice.
        let is_kept = nodes > 1 && scene.state_size().saturating_mul(times.len() as u64) <= memory;
        let kept = if is_kept { times.iter().map(|_| OnceLock::new()).collect() } else { Vec::new() };
        Self { scene, animation, times, kept }
    }

    /// Returns the times (s), at least one.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Whether an animation moves the scene.
    pub fn is_animated(&self) -> bool {
        self.animation.is_some()
    }

    /// Returns the state of all nodes at a time, by its number.
    pub fn state(&self, time: usize) -> Result<Arc<SceneState>, FormatError> {
        let kept = self.kept.get(time);
        if let Some(state) = kept.and_then(OnceLock::get) {
            return Ok(Arc::clone(state));
        }
        let state = self.scene.pose(self.animation, self.times[time])?.state();
        Ok(match kept {
            // Threads that evaluate the same time together find equal states.
            Some(kept) => Arc::clone(kept.get_or_init(|| state)),
            None => state,
        })
    }

    /// Returns the pose for the mesh of one node at a time, by its number.
    pub fn pose_of_node(&self, node: usize, time: usize) -> Result<ScenePose<'_>, FormatError> {
        if self.kept.is_empty() {
            return self.scene.pose_of_node(node, self.animation, self.times[time]);
        }
        Ok(self.pose_of(self.state(time)?))
    }

    /// Returns the pose of a state that [`ScenePoses::state`] returned.
    pub fn pose_of(&self, state: Arc<SceneState>) -> ScenePose<'_> {
        self.scene.pose_of(state)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use sscc_io::gltf::{SkinWeights, parse_scene};

    use super::*;

    /// A mesh at two nodes, one below the other. The positions need no bytes: all are zero.
    fn scene() -> Arc<AnimatedScene> {
        let text = r#"{"asset":{"version":"2.0"},"accessors":[{"componentType":5126,"count":3,"type":"VEC3"}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "nodes":[{"mesh":0,"translation":[0.1,0.2,0.3],"rotation":[0.1,0.2,0.3,1],"children":[1]},
                {"mesh":0,"translation":[0.7,0.9,1.1]}]}"#;
        Arc::new(parse_scene(text.as_bytes()).unwrap())
    }

    fn positions(poses: &ScenePoses, node: usize, time: usize) -> Vec<DVec3> {
        let mut positions = Vec::new();
        let pose = poses.pose_of_node(node, time).unwrap();
        pose.positions(node, SkinWeights::Normalized, &mut positions).unwrap();
        positions
    }

    #[test]
    fn all_nodes_share_one_state_of_each_time() {
        let poses = ScenePoses::new(scene(), None, vec![0.0, 1.0], 2);
        let states = [0, 1, 0, 1].map(|time| poses.state(time).unwrap());
        assert!(Arc::ptr_eq(&states[0], &states[2]) && Arc::ptr_eq(&states[1], &states[3]));
        assert!(!Arc::ptr_eq(&states[0], &states[1]));
        for node in [0, 1] {
            assert!(Arc::ptr_eq(&poses.pose_of_node(node, 1).unwrap().state(), &states[1]));
        }
    }

    #[test]
    fn positions_do_not_depend_on_kept_states() {
        let scene = scene();
        let size = scene.state_size();
        let poses =
            |nodes, memory| ScenePoses::with_memory(Arc::clone(&scene), None, vec![0.0, 1.0], nodes, memory);
        let kept = poses(2, 2 * size);
        assert_eq!(kept.kept.len(), 2);
        for other in [poses(2, 2 * size - 1), poses(1, u64::MAX)] {
            assert!(other.kept.is_empty());
            for node in [0, 1] {
                assert_eq!(positions(&other, node, 1), positions(&kept, node, 1));
                let mut whole = Vec::new();
                let pose = other.pose_of(other.state(1).unwrap());
                pose.positions(node, SkinWeights::Normalized, &mut whole).unwrap();
                assert_eq!(whole, positions(&kept, node, 1));
            }
        }
    }
}
