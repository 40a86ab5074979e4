//! The scene of a glTF file: nodes, meshes, skins and animations.

use std::collections::BTreeMap;
use std::fmt;

use super::animation::{Animation, AnimationInfo};
use super::mesh_node::MeshNode;
use super::nodes::Nodes;
use super::skin::Skin;
use crate::FormatError;

/// All nodes with a mesh, skins and animations of a glTF file. [`AnimatedScene::pose`] evaluates them at a time.
///
/// Nodes count whether or not one of the file's scenes contains them. Vertices are in the unit of the file (by the
/// standard: metres), times in seconds.
///
/// ```no_run
/// use sscc_io::gltf::{SkinWeights, read_scene};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scene = read_scene("fox.glb".as_ref())?;
/// let mut positions = Vec::new();
/// for frame in 0..=100 {
///     let pose = scene.pose(Some(0), scene.animations()[0].last_time * f64::from(frame) / 100.0)?;
///     for mesh_node in scene.mesh_nodes() {
///         pose.positions(mesh_node.node(), SkinWeights::Normalized, &mut positions)?;
///     }
/// }
/// # Ok(())
/// # }
/// ```
pub struct AnimatedScene {
    pub(super) nodes: Nodes,
    pub(super) mesh_nodes: Vec<MeshNode>,
    /// Skins that nodes with a mesh use, by their numbers.
    pub(super) skins: BTreeMap<usize, Skin>,
    /// Animations; the errors of those that are malformed.
    pub(super) animations: Vec<Result<Animation, FormatError>>,
    pub(super) infos: Vec<AnimationInfo>,
    pub(super) notes: Vec<String>,
}

impl AnimatedScene {
    /// Nodes that show a mesh with triangles, in file order. A strip whose triangles all have repeated corners has none.
    pub fn mesh_nodes(&self) -> &[MeshNode] {
        &self.mesh_nodes
    }

    /// Returns a node with a mesh by its number.
    pub(super) fn mesh_node(&self, node: usize) -> Option<&MeshNode> {
        self.mesh_nodes.get(self.mesh_nodes.binary_search_by_key(&node, |mesh_node| mesh_node.node).ok()?)
    }

    /// Lines about data that the standard requires but the meshes lack, and how the reader replaces them; about extensions
    /// that are not evaluated; about nodes that are left out because the strips of their meshes have no triangles.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Animations, in file order.
    pub fn animations(&self) -> &[AnimationInfo] {
        &self.infos
    }
}

impl fmt::Debug for AnimatedScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnimatedScene")
            .field("mesh_nodes", &self.mesh_nodes)
            .field("animations", &self.infos)
            .finish_non_exhaustive()
    }
}
