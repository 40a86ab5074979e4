//! A mesh of a glTF file with its morph targets, all primitives joined.

use sscc::{Modes, TriMesh};

use super::accessors::Accessors;
use super::buffers::Buffers;
use super::joined::{JoinedPrimitives, PrimitiveRange};
use super::json::{Extras, Mesh, Root};
use super::triangles::{morph_targets, with_triangles};
use crate::FormatError;

/// A mesh with morph targets. Vertex and triangle numbers run through its primitives in file order.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MorphModel {
    /// The base mesh, in its own coordinates: [`PlacedMesh`](super::PlacedMesh) applies node transforms.
    pub mesh: TriMesh,
    /// Mode k is the displacement of target k.
    pub modes: Modes,
    /// Default weights of the mesh, a q (r numbers); zeros if the file has none. They are not applied to `mesh`.
    pub default_weights: Vec<f64>,
    /// Names of the targets (r); `target 0`, `target 1`, ... if the file does not have one for each.
    pub target_names: Vec<String>,
    /// Name of the mesh; `#0` for an unnamed first mesh, and so on.
    pub mesh_name: String,
    /// Ranges of the primitives with triangles, in file order.
    pub primitives: Vec<PrimitiveRange>,
    /// Lines about data that the standard requires but the file lacks, and how the reader replaces them.
    pub notes: Vec<String>,
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
    let rank = morph_targets(mesh);
    let used = with_triangles(mesh).flat_map(|(_, p)| {
        let targets = p.targets.iter().filter_map(|t| t.position);
        p.attributes.position.into_iter().chain(p.indices).chain(targets)
    });
    let mut accessors = Accessors::new(root, buffers, used, size)?;
    let mut joined = JoinedPrimitives::new(rank);
    let mut primitives = Vec::new();
    for (number, primitive) in with_triangles(mesh) {
        let part = format!("meshes[{index}].primitives[{number}]");
        primitives.push(joined.push(&mut accessors, number, primitive, &part)?);
    }
    Ok(MorphModel {
        mesh: TriMesh::new(joined.positions, joined.faces)?.with_split_vertices(),
        modes: Modes::new(rank, joined.displacements)?,
        default_weights: fitted_weights(&mesh.weights, rank),
        target_names: target_names(mesh, rank),
        mesh_name,
        primitives,
        notes: notes(mesh, index),
    })
}

/// Returns notes on a mesh whose numbers of morph targets differ, or differ from that of its weights.
pub(super) fn notes(mesh: &Mesh, index: usize) -> Vec<String> {
    let rank = morph_targets(mesh);
    let fewest = with_triangles(mesh).map(|(_, primitive)| primitive.targets.len()).min().unwrap_or(0);
    let targets = (fewest < rank).then(|| {
        format!(
            "meshes[{index}]: its primitives have {fewest} to {rank} morph targets; the missing ones move nothing"
        )
    });
    let weights = (!mesh.weights.is_empty() && mesh.weights.len() != rank).then(|| {
        let found = mesh.weights.len();
        format!(
            "meshes[{index}]: it has {found} default weights for {rank} morph targets; missing ones are 0, others left out"
        )
    });
    targets.into_iter().chain(weights).collect()
}

/// Returns as many of these stored weights as there are morph targets; missing ones are 0.
pub(super) fn fitted_weights(stored: &[f64], rank: usize) -> Vec<f64> {
    stored.iter().copied().chain(std::iter::repeat(0.0)).take(rank).collect()
}

/// Returns the names of the morph targets of a mesh.
pub(super) fn target_names(mesh: &Mesh, rank: usize) -> Vec<String> {
    match &mesh.extras {
        Some(Extras::Names { target_names }) if target_names.len() == rank => target_names.clone(),
        _ => (0..rank).map(|k| format!("target {k}")).collect(),
    }
}
