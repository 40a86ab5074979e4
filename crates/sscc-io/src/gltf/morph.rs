//! A mesh of a glTF file with its morph targets, all primitives joined.

use std::ops::Range;

use glam::DVec3;
use sscc::{Modes, TriMesh};

use super::accessors::{Accessors, Role};
use super::buffers::Buffers;
use super::json::{Extras, Mesh, Primitive, Root};
use super::triangles::Topology;
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

/// Vertices and triangles of one primitive in the joined mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PrimitiveRange {
    /// Vertices.
    pub vertices: Range<u32>,
    /// Triangles.
    pub triangles: Range<u32>,
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
    let mut joined = Assembly {
        accessors: Accessors::new(root, buffers, used, size)?,
        rank,
        positions: Vec::new(),
        faces: Vec::new(),
        displacements: Vec::new(),
    };
    let mut primitives = Vec::new();
    for (number, primitive) in mesh.primitives.iter().enumerate() {
        let part = format!("meshes[{index}].primitives[{number}]");
        primitives.push(joined.push(primitive, &part)?);
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

struct Assembly<'a> {
    accessors: Accessors<'a>,
    rank: usize,
    positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    /// `rank` displacements for each vertex.
    displacements: Vec<DVec3>,
}

impl Assembly<'_> {
    fn push(&mut self, primitive: &Primitive, part: &str) -> Result<PrimitiveRange, FormatError> {
        let refused = |cause: String| FormatError::part(part, cause);
        primitive.extensions.check(|| part.into())?;
        let topology = Topology::from_mode(primitive.mode)
            .map_err(|kind| refused(format!("a primitive of triangles was expected, this one has {kind}")))?;
        if primitive.targets.len() != self.rank {
            let cause = format!(
                "it has {} morph targets, the first primitive {}: all need the same number",
                primitive.targets.len(),
                self.rank
            );
            return Err(refused(cause));
        }
        let Some(base) = primitive.attributes.position else {
            return Err(refused("it has no positions".into()));
        };
        let count = self.accessors.count(base)?;
        self.take(count, 24 * (1 + self.rank as u64), part)?;
        let positions = vectors(&self.accessors.read(base, Role::Positions)?);
        let mut columns = Vec::new();
        for (k, target) in primitive.targets.iter().enumerate() {
            // A target without positions only changes normals or colours.
            let Some(accessor) = target.position else {
                columns.push(Vec::new());
                continue;
            };
            let moved = self.accessors.count(accessor)?;
            if moved != count {
                return Err(refused(format!("target {k} has {moved} positions for {count} vertices")));
            }
            self.take(count, 24, part)?;
            columns.push(vectors(&self.accessors.read(accessor, Role::Positions)?));
        }
        let faces = self.faces_of(primitive, topology, count, part)?;
        let (v, t) = (self.positions.len(), self.faces.len());
        let range = |from: usize, more: usize| match (u32::try_from(from), u32::try_from(from + more)) {
            (Ok(begin), Ok(end)) => Ok(begin..end),
            _ => Err(refused(format!(
                "with it the mesh has {} vertices or triangles: 32-bit indices allow at most 2^32 - 1",
                from + more
            ))),
        };
        let ranges = PrimitiveRange { vertices: range(v, count)?, triangles: range(t, faces.len())? };
        let first = ranges.vertices.start;
        self.faces.extend(faces.iter().map(|face| face.map(|vertex| first + vertex)));
        self.positions.extend(&positions);
        let columns = &columns;
        let rows =
            (0..count).flat_map(|v| columns.iter().map(move |c| c.get(v).copied().unwrap_or_default()));
        self.displacements.extend(rows);
        Ok(ranges)
    }

    /// Returns the triangles of a primitive, with its own vertex numbers, which are below `count`.
    fn faces_of(
        &mut self,
        primitive: &Primitive,
        topology: Topology,
        count: usize,
        part: &str,
    ) -> Result<Vec<[u32; 3]>, FormatError> {
        let refused = |cause: String| FormatError::part(part, cause);
        let corners: Vec<u32> = match primitive.indices {
            Some(indices) => {
                // A strip has up to 12 bytes of a triangle for each corner, and lists are copied once.
                let corners = self.accessors.count(indices)?;
                self.take(corners, 28, part)?;
                self.accessors.read(indices, Role::Indices)?.into_iter().map(|index| index as u32).collect()
            }
            None => {
                self.take(count, 28, part)?;
                (0..u32::try_from(count).map_err(|_| {
                    refused(format!("it has {count} vertices: 32-bit indices allow at most 2^32 - 1"))
                })?)
                    .collect()
            }
        };
        if let Some(largest) = corners.iter().max().filter(|index| **index as usize >= count) {
            let cause = format!("names vertex {largest} (counted from 0), but there are {count}");
            return Err(refused(cause));
        }
        topology.triangles(&corners).ok_or_else(|| {
            refused(format!("{} indices are not a multiple of 3: each triangle needs three", corners.len()))
        })
    }

    fn take(&mut self, count: usize, size: u64, part: &str) -> Result<(), FormatError> {
        self.accessors.allowance.take(count as u64, size).map_err(|cause| FormatError::part(part, cause))
    }
}

fn vectors(values: &[f64]) -> Vec<DVec3> {
    values.as_chunks().0.iter().map(|xyz| DVec3::from_array(*xyz)).collect()
}

fn default_weights(mesh: &Mesh, rank: usize, index: usize) -> Result<Vec<f64>, FormatError> {
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
