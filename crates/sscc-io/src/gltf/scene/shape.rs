//! A mesh with morph targets and influences, shared by the nodes that show it.

use glam::DVec3;
use sscc::limits;

use super::influences::Influences;
use super::json;
use super::weld::weld_classes;
use crate::FormatError;
use crate::gltf::accessors::Accessors;
use crate::gltf::joined::JoinedPrimitives;
use crate::gltf::json::Mesh;
use crate::gltf::triangles::with_triangles;

/// A mesh of the file: its primitives of triangles joined.
pub(super) struct Shape {
    pub rest: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
    /// The end of each primitive's triangles, with its number in the mesh.
    pub primitives: Vec<(usize, u32)>,
    pub rank: usize,
    /// `rank` displacements for each vertex.
    displacements: Vec<DVec3>,
    /// Influences, for nodes with a skin.
    pub influences: Option<Influences>,
    pub weld_classes: Vec<u32>,
}

impl Shape {
    /// Reads a mesh with its first `rank` morph targets; `number` is its place in the file. Influences are read for nodes
    /// with a skin alone.
    pub fn read(
        accessors: &mut Accessors<'_>,
        number: usize,
        mesh: &Mesh,
        rank: usize,
        skin_attributes: Option<&json::Mesh>,
    ) -> Result<Self, FormatError> {
        let mut joined = JoinedPrimitives::new(rank);
        let mut influences = skin_attributes.map(|_| Influences::new());
        let mut primitives = Vec::new();
        for (at, primitive) in with_triangles(mesh) {
            let part = format!("meshes[{number}].primitives[{at}]");
            let range = joined.push(accessors, at, primitive, &part)?;
            primitives.push((at, range.triangles.end));
            if let (Some(influences), Some(mesh)) = (&mut influences, skin_attributes) {
                let attributes = &mesh.primitives[at].attributes;
                if primitive.extensions.is_compressed() {
                    for (_, accessor) in attributes.joints.iter().chain(&attributes.weights) {
                        accessors.check_uncompressed(*accessor, &part)?;
                    }
                }
                influences.push(accessors, attributes, range.vertices.len(), &part)?;
            }
        }
        let JoinedPrimitives { positions: rest, faces, displacements, .. } = joined;
        let refused = |cause: String| FormatError::part(format!("meshes[{number}]"), cause);
        if let Some(vertex) = rest.iter().position(|p| !limits::contains(*p)) {
            let cause =
                format!("the position of vertex {vertex} (counted from 0) is not finite, or beyond 2^200");
            return Err(refused(cause));
        }
        if let Some(entry) = displacements.iter().position(|p| !limits::contains(*p)) {
            let (target, vertex) = (entry % rank, entry / rank);
            let cause =
                format!("target {target} of vertex {vertex} (counted from 0) is not finite, or beyond 2^200");
            return Err(refused(cause));
        }
        if let Some(influences) = &mut influences {
            influences.finish();
        }
        accessors.allowance.take(rest.len() as u64, 16).map_err(refused)?;
        let weld_classes = weld_classes(&rest, rank, &displacements, influences.as_ref());
        Ok(Self { rest, faces, primitives, rank, displacements, influences, weld_classes })
    }

    /// Appends the position of each vertex after morphing with these weights (`rank` numbers).
    pub fn morphed_positions(&self, weights: &[f64], positions: &mut Vec<DVec3>) {
        positions.extend((0..self.rest.len()).map(|vertex| self.morphed(vertex, weights)));
    }

    fn morphed(&self, vertex: usize, weights: &[f64]) -> DVec3 {
        sscc::deformed_position(
            self.rest[vertex],
            &self.displacements[vertex * self.rank..][..self.rank],
            weights,
        )
    }
}
