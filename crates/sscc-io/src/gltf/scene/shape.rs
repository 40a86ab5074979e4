//! A mesh with morph targets and influences, shared by the nodes that show it.

use glam::{DMat4, DVec3};
use sscc::limits;

use super::influences::Influences;
use super::json;
use super::weld::weld_classes;
use crate::FormatError;
use crate::gltf::accessors::Accessors;
use crate::gltf::joined::JoinedPrimitives;
use crate::gltf::json::Mesh;
use crate::gltf::triangles::Topology;

/// Weights of joints that do not sum to 1, an error by the standard that files contain nevertheless.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SkinWeights {
    /// Divide the weights of each vertex by their sum, as three.js does. A vertex whose weights are all 0 follows its
    /// first joint (`JOINTS_0.x`) alone.
    #[default]
    Normalized,
    /// Use the weights of the file. A vertex whose weights are all 0 is at the origin of the world.
    AsStored,
}

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

/// Number of morph targets of a mesh.
pub(super) fn morph_targets(mesh: &Mesh) -> usize {
    let first = mesh.primitives.iter().find(|primitive| Topology::from_mode(primitive.mode).is_ok());
    first.or(mesh.primitives.first()).map_or(0, |primitive| primitive.targets.len())
}

impl Shape {
    /// Reads a mesh; `number` is its place in the file. Influences are read for nodes with a skin alone.
    pub fn read(
        accessors: &mut Accessors<'_>,
        number: usize,
        mesh: &Mesh,
        skin_attributes: Option<&json::Mesh>,
    ) -> Result<Self, FormatError> {
        let rank = morph_targets(mesh);
        let mut joined = JoinedPrimitives::new(rank);
        let mut influences = skin_attributes.map(|_| Influences::new());
        let mut primitives = Vec::new();
        for (at, primitive) in mesh.primitives.iter().enumerate() {
            if Topology::from_mode(primitive.mode).is_err() {
                continue;
            }
            let part = format!("meshes[{number}].primitives[{at}]");
            let range = joined.push(accessors, primitive, &part)?;
            primitives.push((at, range.triangles.end));
            if let (Some(influences), Some(mesh)) = (&mut influences, skin_attributes) {
                let attributes = &mesh.primitives[at].attributes;
                influences.push(accessors, attributes, range.vertices.len(), &part)?;
            }
        }
        let JoinedPrimitives { positions: rest, faces, displacements, .. } = joined;
        let refused = |cause: String| FormatError::part(format!("meshes[{number}]"), cause);
        if let Some(vertex) = rest.iter().position(|p| !limits::contains(*p)) {
            return Err(refused(format!("the position of vertex {vertex} (counted from 0) is not finite")));
        }
        if let Some(entry) = displacements.iter().position(|p| !limits::contains(*p)) {
            let cause =
                format!("target {} of vertex {} (counted from 0) is not finite", entry % rank, entry / rank);
            return Err(refused(cause));
        }
        if let Some(influences) = &mut influences {
            influences.finish();
        }
        accessors.allowance.take(rest.len() as u64, 16).map_err(refused)?;
        let weld_classes = weld_classes(&rest, rank, &displacements, influences.as_ref());
        Ok(Self { rest, faces, primitives, rank, displacements, influences, weld_classes })
    }

    /// Appends the position of each vertex after morphing with these weights (`rank` numbers) and the transform.
    pub fn transformed(&self, weights: &[f64], world: &DMat4, positions: &mut Vec<DVec3>) {
        let vertices = 0..self.rest.len();
        positions.extend(vertices.map(|v| world.transform_point3(self.morphed(v, weights))));
    }

    /// Appends the position of each vertex after morphing and skinning. `joints` has the transform of each used joint.
    pub fn skinned(
        &self,
        influences: &Influences,
        weights: &[f64],
        joints: &[DMat4],
        reading: SkinWeights,
        positions: &mut Vec<DVec3>,
    ) {
        positions.extend((0..self.rest.len()).map(|vertex| {
            let morphed = self.morphed(vertex, weights);
            let influences = influences.of_vertex(vertex);
            let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
            let share = |weight: f64| match reading {
                SkinWeights::AsStored => weight,
                // The only influence of a vertex without weights.
                SkinWeights::Normalized if sum == 0.0 => 1.0,
                SkinWeights::Normalized => weight / sum,
            };
            let moved = |(joint, weight): &(u32, f64)| {
                joints[*joint as usize].transform_point3(morphed) * share(*weight)
            };
            influences.iter().map(moved).sum::<DVec3>()
        }));
    }

    fn morphed(&self, vertex: usize, weights: &[f64]) -> DVec3 {
        sscc::deformed_position(
            self.rest[vertex],
            &self.displacements[vertex * self.rank..][..self.rank],
            weights,
        )
    }
}
