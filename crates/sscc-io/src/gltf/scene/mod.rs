//! Animated scenes: world positions of meshes with morph targets and skins, as a player shows them.
//!
//! Evaluation is in double precision. It follows version 2.0 of the format: node hierarchy, one animation alone, morph
//! targets, then skins with all sets of joints.

mod animated_scene;
mod animation;
mod animation_reader;
mod find;
mod influences;
mod json;
mod mesh_node;
mod nodes;
mod pose;
mod read;
mod rotation;
mod sampler;
mod shape;
mod skin;
mod transform;
mod weld;

pub use animated_scene::AnimatedScene;
pub use animation::AnimationInfo;
pub use mesh_node::MeshNode;
pub use pose::ScenePose;
pub use read::{parse_scene, read_scene};
pub use shape::SkinWeights;

#[cfg(test)]
mod tests;
