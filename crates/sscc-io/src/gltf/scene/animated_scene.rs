//! The scene of a glTF file: nodes, meshes, skins and animations.

use std::collections::BTreeMap;
use std::fmt;

use super::animation::{Animation, AnimationInfo};
use super::mesh_node::MeshNode;
use super::nodes::Nodes;
use super::skin::Skin;
use crate::FormatError;

/// The nodes with a mesh that a player shows, skins and animations of a glTF file. [`AnimatedScene::pose`] evaluates them at a
/// time.
///
/// A player shows the nodes of the default scene that KHR_node_visibility does not hide; those that an animation can show count
/// as shown at all times. If it shows no mesh, all nodes with a mesh count. Joints and animated ancestors are evaluated wherever
/// they are. Vertices are in the unit of the file (by the standard: metres), times in seconds.
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
    /// Nodes with a mesh that a player shows, in file order.
    pub(super) mesh_nodes: Vec<MeshNode>,
    /// The other nodes with a mesh, in file order.
    pub(super) left_out: Vec<MeshNode>,
    /// Skins that nodes with a mesh use, by their numbers.
    pub(super) skins: BTreeMap<usize, Skin>,
    /// Animations; the errors of those that are malformed.
    pub(super) animations: Vec<Result<Animation, FormatError>>,
    pub(super) infos: Vec<AnimationInfo>,
    pub(super) notes: Vec<String>,
}

impl AnimatedScene {
    /// Nodes that show a mesh with triangles, in file order. A strip whose triangles all have repeated corners has none. Nodes
    /// that a player does not show are left out; [`AnimatedScene::find_mesh_nodes`] finds them by number or name.
    pub fn mesh_nodes(&self) -> &[MeshNode] {
        &self.mesh_nodes
    }

    /// Lines about data that the standard requires but the meshes lack, and how the reader replaces them; about extensions
    /// that are not evaluated; about nodes that are left out because the strips of their meshes have no triangles, or because a
    /// player does not show them.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Animations, in file order.
    pub fn animations(&self) -> &[AnimationInfo] {
        &self.infos
    }

    /// Returns a node with a mesh by its number, also one that a player does not show.
    pub(super) fn mesh_node(&self, node: usize) -> Option<&MeshNode> {
        self.mesh_nodes_of_number(node)?.first()
    }

    /// As [`AnimatedScene::mesh_node`], as a list of this node.
    pub(super) fn mesh_nodes_of_number(&self, node: usize) -> Option<&[MeshNode]> {
        [&self.mesh_nodes, &self.left_out].into_iter().find_map(|nodes| {
            let at = nodes.binary_search_by_key(&node, |mesh_node| mesh_node.node).ok()?;
            nodes.get(at..=at)
        })
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
