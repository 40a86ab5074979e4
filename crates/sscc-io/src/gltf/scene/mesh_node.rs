//! Nodes that show a mesh.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use super::shape::Shape;
use crate::FormatError;
use crate::gltf::part_names::PartNames;
use crate::named_groups::{GroupCollector, GroupsBy, NamedGroups};

/// A node of a glTF file that shows a mesh with triangles. Vertex and triangle numbers run through the mesh's primitives
/// of triangles in file order; primitives of points and lines are left out.
pub struct MeshNode {
    pub(super) node: usize,
    pub(super) name: Option<String>,
    pub(super) mesh: usize,
    pub(super) mesh_name: Option<String>,
    pub(super) skin: Option<usize>,
    /// Stored weights of the morph targets.
    pub(super) weights: Vec<f64>,
    pub(super) shape: Arc<Shape>,
    pub(super) names: Arc<Result<PartNames, FormatError>>,
}

impl MeshNode {
    /// Index of the node in the file.
    pub fn node(&self) -> usize {
        self.node
    }

    /// Name of the node, if the file has one. Names may repeat.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Index of the mesh in the file.
    pub fn mesh(&self) -> usize {
        self.mesh
    }

    /// Name of the mesh, if the file has one. Names may repeat.
    pub fn mesh_name(&self) -> Option<&str> {
        self.mesh_name.as_deref()
    }

    /// Index of the skin in the file; None if the node moves the mesh by its own transform.
    pub fn skin(&self) -> Option<usize> {
        self.skin
    }

    /// Whether a skin deforms the mesh.
    pub fn is_skinned(&self) -> bool {
        self.skin.is_some()
    }

    /// Number of morph targets.
    pub fn morph_targets(&self) -> usize {
        self.shape.rank
    }

    /// Faces (N, at least 1): three vertex indices each. Nodes with the same mesh share them.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.shape.faces
    }

    /// Rest positions (V) in the mesh's own coordinates, without morph targets.
    pub fn rest_positions(&self) -> &[DVec3] {
        &self.shape.rest
    }

    /// Weld class of each vertex (V): the smallest index of a vertex with equal rest position, displacements in all
    /// morph targets and influences (without weights of 0; no influences without a skin). 0 equals -0.
    pub fn weld_classes(&self) -> &[u32] {
        &self.shape.weld_classes
    }

    /// Returns the group of each triangle.
    ///
    /// # Errors
    /// When a name or the material of a primitive is malformed, or there are more than 65,536 groups.
    pub fn groups(&self, by: GroupsBy) -> Result<NamedGroups, FormatError> {
        let names = (*self.names).as_ref().map_err(Clone::clone)?;
        let mut groups = GroupCollector::default();
        for &(primitive, end) in &self.shape.primitives {
            groups.extend_to(end as usize, &names.group(by, Some(self.node), self.mesh, primitive))?;
        }
        Ok(groups.finish())
    }

    /// The largest |sum of weights - 1| of a vertex as stored, 0 without a skin. Up to about 1e-2 it is rounding of
    /// integer weights; beyond, the file breaks the standard, and players differ (see [`SkinWeights`](super::SkinWeights)).
    pub fn largest_weight_error(&self) -> f64 {
        self.shape.influences.as_ref().map_or(0.0, |influences| influences.largest_sum_error)
    }
}

impl fmt::Debug for MeshNode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MeshNode")
            .field("node", &self.node)
            .field("name", &self.name)
            .field("mesh", &self.mesh)
            .field("skin", &self.skin)
            .field("vertices", &self.shape.rest.len())
            .field("faces", &self.shape.faces.len())
            .finish_non_exhaustive()
    }
}
