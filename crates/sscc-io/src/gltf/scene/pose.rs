//! Evaluation of a scene at a time.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3};
use sscc::limits;

use super::animated_scene::AnimatedScene;
use super::animation::NodeStates;
use super::shape::SkinWeights;
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
    /// does not move have their stored values. Times before the first or after the last key frame of a channel count as
    /// that key frame's. Costs O(nodes + channels log key frames).
    ///
    /// # Errors
    /// When there is no such animation, it has no key frames, or the time is NaN.
    pub fn pose(&self, animation: Option<usize>, time: f64) -> Result<ScenePose<'_>, FormatError> {
        let moved = match animation {
            None => NodeStates { transforms: Vec::new(), weights: BTreeMap::new() },
            Some(number) => {
                let refused = |cause: String| FormatError::part(format!("animations[{number}]"), cause);
                let count = self.animations.len();
                let Some(animation) = self.animations.get(number) else {
                    return Err(refused(format!("there is no such animation; the file has {count}")));
                };
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
    /// As those.
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
        let mesh_nodes = &self.scene.mesh_nodes;
        let Ok(at) = mesh_nodes.binary_search_by_key(&node, |mesh_node| mesh_node.node) else { return false };
        let mesh_node = &mesh_nodes[at];
        match (&mesh_node.shape.influences, mesh_node.skin) {
            (Some(influences), Some(skin)) => {
                let skin = &self.scene.skins[skin];
                influences.joints.iter().any(|joint| is_flat(&skin.joint_transform(*joint, &self.world)))
            }
            _ => is_flat(&self.world[node]),
        }
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
        let refused = |cause: String| Err(FormatError::part(format!("nodes[{node}]"), cause));
        let mesh_nodes = &self.scene.mesh_nodes;
        let Ok(at) = mesh_nodes.binary_search_by_key(&node, |mesh_node| mesh_node.node) else {
            return refused("it shows no mesh with triangles, or does not exist".into());
        };
        let mesh_node = &mesh_nodes[at];
        let shape = &mesh_node.shape;
        let morph_weights = self.weights.get(&node).unwrap_or(&mesh_node.weights);
        match (&shape.influences, mesh_node.skin) {
            (Some(influences), Some(skin)) => {
                let skin = &self.scene.skins[skin];
                let transform = |joint: &u32| skin.joint_transform(*joint, &self.world);
                let joints: Vec<DMat4> = influences.joints.iter().map(transform).collect();
                shape.skinned(influences, morph_weights, &joints, weights, positions);
            }
            _ => shape.transformed(morph_weights, &self.world[node], positions),
        }
        match positions.iter().position(|x| !limits::contains(*x)) {
            Some(vertex) => {
                refused(format!("the position of vertex {vertex} (counted from 0) is not finite"))
            }
            None => Ok(()),
        }
    }
}

/// Whether a transform maps space to a plane, a line or a point, up to rounding.
fn is_flat(transform: &DMat4) -> bool {
    let axes = DMat3::from_mat4(*transform);
    let lengths = axes.x_axis.length() * axes.y_axis.length() * axes.z_axis.length();
    axes.determinant().abs() <= 1e-14 * lengths
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn scales_of_zero_are_flat() {
        let turn = DMat4::from_quat(DQuat::from_rotation_y(0.3) * DQuat::from_rotation_x(1.1));
        let scaled = |x: f64, y: f64, z: f64| turn * DMat4::from_scale(DVec3::new(x, y, z)) * turn;
        for (x, y, z) in [(0.0, 1.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1e-9, 1e-9, 0.0)] {
            assert!(is_flat(&scaled(x, y, z)), "{x} {y} {z}");
        }
        for (x, y, z) in [(1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (1e-9, 1e-9, 1e-9), (1e-3, 1.0, 1e3)] {
            assert!(!is_flat(&scaled(x, y, z)), "{x} {y} {z}");
        }
    }
}
