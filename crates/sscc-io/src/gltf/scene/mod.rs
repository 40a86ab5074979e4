//! Scenes: world positions of meshes with morph targets and skins, as a player shows them.
//!
//! Evaluation is in double precision. It follows version 2.0 of the format: node hierarchy, one animation alone, morph
//! targets, then skins with all sets of joints.

mod animated_scene;
mod animation;
mod animation_reader;
mod contents;
mod find;
mod influences;
mod json;
mod mesh_node;
mod nodes;
mod place;
mod placed_mesh;
mod pose;
mod read;
mod rotation;
mod sampler;
mod shape;
mod shown;
mod skin;
mod transform;
mod weld;

pub use animated_scene::AnimatedScene;
pub use animation::AnimationInfo;
pub use contents::{
    AnimationContents, Contents, MeshContents, MeshNodeContents, NamedPart, count_meshes, parse_contents,
    read_contents,
};
pub use mesh_node::MeshNode;
pub use place::SkinWeights;
pub use placed_mesh::{PlacedMesh, parse_placed_mesh, read_model_placement, read_placed_mesh};
pub use pose::{ScenePose, SceneState};
pub use read::{parse_scene, read_scene};

#[cfg(test)]
mod tests;
