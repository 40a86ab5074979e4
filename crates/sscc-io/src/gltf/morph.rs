//! A mesh of a glTF file with its morph targets, all primitives joined.

use sscc::{Modes, TriMesh};

use super::accessors::Accessors;
use super::buffers::Buffers;
use super::joined::{JoinedPrimitives, PrimitiveRange};
use super::json::{Extras, Mesh, Root};
use crate::FormatError;

/// A mesh with morph targets. Vertex and triangle numbers run through its primitives in file order.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MorphModel {
    /// The base mesh, in its own coordinates: node transforms are not applied.
    pub mesh: TriMesh,
    /// Mode k is the displacement of target k.
    pub modes: Modes,
    /// Default weights of the mesh, a q (r numbers); zeros if the file has none. They are not applied to `mesh`.
    pub default_weights: Vec<f64>,
    /// Names of the targets (r); `target 0`, `target 1`, ... if the file has none.
    pub target_names: Vec<String>,
    /// Name of the mesh; `#0` for an unnamed first mesh, and so on.
    pub mesh_name: String,
    /// Ranges of the primitives, in file order.
    pub primitives: Vec<PrimitiveRange>,
}

/// Joins the primitives of a mesh. `size` is the size of the file in bytes.
pub(super) fn model(
    root: &Root,
    index: usize,
    mesh_name: String,
    buffers: Buffers<'_>,
    size: u64,
) -> Result<MorphModel, FormatError> {
    let mesh = &root.meshes[index];
    let rank = mesh.primitives.first().map_or(0, |p| p.targets.len());
    let used = mesh.primitives.iter().flat_map(|p| {
        let targets = p.targets.iter().filter_map(|t| t.position);
        p.attributes.position.into_iter().chain(p.indices).chain(targets)
    });
    let mut accessors = Accessors::new(root, buffers, used, size)?;
    let mut joined = JoinedPrimitives::new(rank);
    let mut primitives = Vec::new();
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let part = format!("meshes[{index}].primitives[{number}]");
        primitives.push(joined.push(&mut accessors, primitive, &part)?);
    }
    Ok(MorphModel {
        mesh: TriMesh::new(joined.positions, joined.faces)?,
        modes: Modes::new(rank, joined.displacements)?,
        default_weights: default_weights(mesh, rank, index)?,
        target_names: target_names(mesh, rank),
        mesh_name,
        primitives,
    })
}

/// Returns the weights of a mesh's morph targets, zeros if the file has none.
pub(super) fn default_weights(mesh: &Mesh, rank: usize, index: usize) -> Result<Vec<f64>, FormatError> {
    match mesh.weights.len() {
        0 => Ok(vec![0.0; rank]),
        n if n == rank => Ok(mesh.weights.clone()),
        n => {
            let cause = format!("{n} default weights for {rank} morph targets");
            Err(FormatError::part(format!("meshes[{index}]"), cause))
        }
    }
}

fn target_names(mesh: &Mesh, rank: usize) -> Vec<String> {
    match &mesh.extras {
        Some(Extras::Names { target_names }) if target_names.len() == rank => target_names.clone(),
        _ => (0..rank).map(|k| format!("target {k}")).collect(),
    }
}
