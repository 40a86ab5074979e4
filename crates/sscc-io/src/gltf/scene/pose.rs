//! Evaluation of a scene at a time.

use std::collections::BTreeMap;

use glam::{DMat4, DVec3};

use super::animated_scene::AnimatedScene;
use super::animation::NodeStates;
use super::mesh_node::MeshNode;
use super::place::{Place, SkinWeights, check_positions};
use crate::FormatError;

/// A scene at one time of one animation: all node transforms and morph weights.
pub struct ScenePose<'a> {
    scene: &'a AnimatedScene,
    /// World transforms of all nodes.
    world: Vec<DMat4>,
    /// Animated weights of morph targets, by node.
    weights: BTreeMap<usize, Vec<f64>>,
}

impl AnimatedScene {
    /// Evaluates one animation at a time (s), or the stored state without an animation. Properties that the animation
    /// does not move have their stored values. Times before the first or after the last key frame of a channel give
    /// the values at that key frame. Costs O(nodes + channels log key frames).
    ///
    /// # Errors
    /// When there is no such animation, it has no key frames or is malformed, or the time is NaN.
    pub fn pose(&self, animation: Option<usize>, time: f64) -> Result<ScenePose<'_>, FormatError> {
        let moved = match animation {
            None => NodeStates { transforms: Vec::new(), weights: BTreeMap::new() },
            Some(number) => {
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
                animation.moved_at(time, &self.nodes)?
            }
        };
        let world = self.nodes.world_transforms(&moved.transforms);
        Ok(ScenePose { scene: self, world, weights: moved.weights })
    }

    /// As [`AnimatedScene::pose`] and [`ScenePose::positions`], for one node.
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
        self.pose(animation, time)?.positions(node, weights, positions)
    }
}

impl ScenePose<'_> {
    /// Whether a scale of 0 flattens triangles of the mesh at a node to segments or points: its own, one of its ancestors',
    /// or one of a joint of its skin.
    pub fn is_flattened(&self, node: usize) -> bool {
        self.mesh_node(node).is_some_and(|mesh_node| self.place(mesh_node).is_flat())
    }

    /// Replaces `positions` by the world positions (V, double precision) of the mesh at a node, by its index in the
    /// file. Each vertex is moved by the morph targets first, with the weights of the animation, else of the node, else
    /// of the mesh; then
    /// - with a skin, to `sum w (J B x)` over its influences with world transform J and inverse bind matrix B of the
    ///   joint. The transform of the node itself and the skin's `skeleton` have no effect;
    /// - without a skin, by the world transform of the node.
    ///
    /// # Errors
    /// When the node shows no mesh with triangles, or a position is not finite or exceeds [`sscc::limits::LARGEST`].
    pub fn positions(
        &self,
        node: usize,
        weights: SkinWeights,
        positions: &mut Vec<DVec3>,
    ) -> Result<(), FormatError> {
        positions.clear();
        let place = format!("nodes[{node}]");
        let Some(mesh_node) = self.mesh_node(node) else {
            return Err(FormatError::part(place, "it shows no mesh with triangles, or does not exist"));
        };
        let morph_weights = self.weights.get(&node).unwrap_or(&mesh_node.weights);
        mesh_node.shape.morphed_positions(morph_weights, positions);
        self.place(mesh_node).apply(weights, positions);
        check_positions(positions, &place)
    }

    fn mesh_node(&self, node: usize) -> Option<&MeshNode> {
        let mesh_nodes = &self.scene.mesh_nodes;
        let at = mesh_nodes.binary_search_by_key(&node, |mesh_node| mesh_node.node).ok()?;
        Some(&mesh_nodes[at])
    }

    fn place<'b>(&self, mesh_node: &'b MeshNode) -> Place<'b> {
        let skin = mesh_node.skin.and_then(|skin| self.scene.skins.get(&skin));
        Place::new(mesh_node.node, skin.zip(mesh_node.shape.influences.as_ref()), &self.world)
    }
}
