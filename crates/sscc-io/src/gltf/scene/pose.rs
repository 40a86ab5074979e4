//! Evaluation of a scene at a time.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::animated_scene::AnimatedScene;
use super::animation::{Animation, NodeState, NodeStates};
use super::mesh_node::MeshNode;
use super::place::{Place, SkinWeights, check_positions};
use crate::FormatError;

/// A scene at one time of one animation: node transforms and morph weights.
pub struct ScenePose<'a> {
    scene: &'a AnimatedScene,
    state: Arc<SceneState>,
}

/// The state of a scene's nodes at one time. It does not borrow the scene, so threads can share it and keep it;
/// [`AnimatedScene::pose_of`] returns the pose.
pub struct SceneState {
    world: WorldTransforms,
    /// Animated weights of morph targets, by node.
    weights: BTreeMap<usize, Vec<f64>>,
}

/// World transforms by the number of the node.
enum WorldTransforms {
    All(Vec<DMat4>),
    /// Those that the mesh of one node needs.
    OfOneMesh(BTreeMap<usize, DMat4>),
}

impl WorldTransforms {
    fn get(&self, node: usize) -> Option<DMat4> {
        match self {
            Self::All(all) => all.get(node).copied(),
            Self::OfOneMesh(some) => some.get(&node).copied(),
        }
    }
}

impl AnimatedScene {
    /// Evaluates one animation at a time (s), or the stored state without an animation. Properties that the animation
    /// does not move have their stored values. Times before the first or after the last key frame of a channel give
    /// the values at that key frame. Costs O(nodes + channels log key frames).
    ///
    /// # Errors
    /// When there is no such animation, it has no key frames or is malformed, or the time is NaN.
    pub fn pose(&self, animation: Option<usize>, time: f64) -> Result<ScenePose<'_>, FormatError> {
        let mut moved = match self.valid_animation(animation, time)? {
            None => NodeStates::default(),
            Some(animation) => animation.moved_at(time, &self.nodes)?,
        };
        // Weights of other nodes are never read, and not counted in the size of a state.
        moved.weights.retain(|node, _| self.mesh_node(*node).is_some());
        let world = WorldTransforms::All(self.nodes.world_transforms(&moved.transforms));
        Ok(self.pose_of(Arc::new(SceneState { world, weights: moved.weights })))
    }

    /// As [`AnimatedScene::pose`], for the mesh of one node alone: the pose has no positions of other nodes. Positions are the
    /// same to the last bit. Costs O(d log c), where d is the number of ancestors of the node, or of the joints of its skin, and c
    /// that of channels.
    ///
    /// # Errors
    /// As [`AnimatedScene::pose`].
    pub fn pose_of_node(
        &self,
        node: usize,
        animation: Option<usize>,
        time: f64,
    ) -> Result<ScenePose<'_>, FormatError> {
        let animation = self.valid_animation(animation, time)?;
        let state = |node: usize| match animation {
            None => Ok(NodeState::default()),
            Some(animation) => animation.node_at(node, time, &self.nodes),
        };
        let (mut world, mut weights) = (BTreeMap::new(), BTreeMap::new());
        if let Some(mesh_node) = self.mesh_node(node) {
            for needed in self.nodes_of_place(mesh_node) {
                let moved = |node: usize| state(node).map(|state| state.transform);
                self.nodes.add_world_transforms(needed, moved, &mut world)?;
            }
            weights.extend(state(node)?.weights.map(|weights| (node, weights)));
        }
        Ok(self.pose_of(Arc::new(SceneState { world: WorldTransforms::OfOneMesh(world), weights })))
    }

    /// Returns the pose of a state of this scene: [`ScenePose::state`] returned it.
    pub fn pose_of(&self, state: Arc<SceneState>) -> ScenePose<'_> {
        ScenePose { scene: self, state }
    }

    /// Returns the largest memory of the state of all nodes at one time (bytes).
    pub fn state_size(&self) -> u64 {
        let weights =
            self.mesh_nodes.iter().map(|mesh_node| WEIGHTS_SIZE + 8 * mesh_node.morph_targets() as u64);
        let world = self.nodes.len() as u64 * size_of::<DMat4>() as u64;
        STATE_SIZE + world + weights.sum::<u64>()
    }

    /// As [`AnimatedScene::pose_of_node`] and [`ScenePose::positions`].
    ///
    /// # Errors
    /// As these two functions.
    pub fn positions(
        &self,
        node: usize,
        animation: Option<usize>,
        time: f64,
        weights: SkinWeights,
        positions: &mut Vec<DVec3>,
    ) -> Result<(), FormatError> {
        self.pose_of_node(node, animation, time)?.positions(node, weights, positions)
    }

    /// Returns the animation of a number, which can be evaluated at a time; None for the stored state.
    fn valid_animation(
        &self,
        animation: Option<usize>,
        time: f64,
    ) -> Result<Option<&Animation>, FormatError> {
        let Some(number) = animation else { return Ok(None) };
        let refused = |cause: String| FormatError::part(format!("animations[{number}]"), cause);
        let count = self.animations.len();
        let Some(animation) = self.animations.get(number) else {
            return Err(refused(format!("there is no such animation; the file has {count}")));
        };
        let animation = animation.as_ref().map_err(FormatError::clone)?;
        if self.infos[number].channels == 0 {
            let cause = match self.infos[number].extension_channels {
                0 => "it has no key frames",
                _ => "all of its channels are those of extensions, which are not supported",
            };
            return Err(refused(cause.into()));
        }
        if time.is_nan() {
            return Err(refused("the time is not a number".into()));
        }
        Ok(Some(animation))
    }

    /// Returns the nodes whose world transforms place a mesh: the node itself, or the joints that its vertices use.
    fn nodes_of_place(&self, mesh_node: &MeshNode) -> Vec<usize> {
        let skin = mesh_node.skin.and_then(|skin| self.skins.get(&skin));
        match skin.zip(mesh_node.shape.influences.as_ref()) {
            Some((skin, influences)) => influences.joints.iter().map(|joint| skin.node(*joint)).collect(),
            None => vec![mesh_node.node],
        }
    }
}

/// Memory of a state beside its nodes (bytes).
const STATE_SIZE: u64 = 256;

/// Memory of the animated weights of a node beside the weights (bytes).
const WEIGHTS_SIZE: u64 = 64;

impl ScenePose<'_> {
    /// Returns the state of the nodes.
    pub fn state(&self) -> Arc<SceneState> {
        Arc::clone(&self.state)
    }

    /// Whether a scale of 0 flattens triangles of the mesh at a node to segments or points: its own, one of its ancestors',
    /// or one of a joint of its skin.
    pub fn is_flattened(&self, node: usize) -> bool {
        self.scene.mesh_node(node).is_some_and(|mesh_node| self.place(mesh_node).is_flat())
    }

    /// Replaces `positions` by the world positions (V, double precision) of the mesh at a node, by its index in the
    /// file. Each vertex is moved by the morph targets first, with the weights of the animation, else of the node, else
    /// of the mesh; then
    /// - with a skin, to `sum w (J B x)` over its influences with world transform J and inverse bind matrix B of the
    ///   joint. The transform of the node itself and the skin's `skeleton` have no effect;
    /// - without a skin, by the world transform of the node.
    ///
    /// # Errors
    /// When the node shows no mesh with triangles, or a position is not finite or exceeds [`sscc::limits::LARGEST`]; when the pose
    /// is that of another node alone.
    pub fn positions(
        &self,
        node: usize,
        weights: SkinWeights,
        positions: &mut Vec<DVec3>,
    ) -> Result<(), FormatError> {
        positions.clear();
        let place = format!("nodes[{node}]");
        let Some(mesh_node) = self.scene.mesh_node(node) else {
            return Err(FormatError::part(place, "it shows no mesh with triangles, or does not exist"));
        };
        let morph_weights = self.state.weights.get(&node).unwrap_or(&mesh_node.weights);
        mesh_node.shape.morphed_positions(morph_weights, positions);
        self.place(mesh_node).apply(weights, positions);
        check_positions(positions, &place)
    }

    fn place<'b>(&self, mesh_node: &'b MeshNode) -> Place<'b> {
        let skin = mesh_node.skin.and_then(|skin| self.scene.skins.get(&skin));
        // A pose of another node lacks transforms: its positions are then not finite, and refused.
        let world = |node: usize| self.state.world.get(node).unwrap_or(DMat4::NAN);
        Place::new(mesh_node.node, skin.zip(mesh_node.shape.influences.as_ref()), world)
    }
}
