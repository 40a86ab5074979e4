//! Primitives of a mesh joined: vertex and triangle numbers run through them in file order.

use std::ops::Range;

use glam::DVec3;

use super::accessors::Accessors;
use super::json::Primitive;
use super::role::Role;
use super::triangles::Topology;
use crate::FormatError;

/// Vertices and triangles of one primitive in the joined mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct PrimitiveRange {
    /// Number of the primitive in its mesh. Primitives without triangles have no range.
    pub number: usize,
    /// Vertices.
    pub vertices: Range<u32>,
    /// Triangles.
    pub triangles: Range<u32>,
}

/// Positions, faces and morph targets of primitives, joined in file order.
pub(super) struct JoinedPrimitives {
    rank: usize,
    pub positions: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
    /// `rank` displacements for each vertex.
    pub displacements: Vec<DVec3>,
}

impl JoinedPrimitives {
    /// Creates a mesh without primitives. The first `rank` morph targets of each are read; missing ones move nothing.
    pub fn new(rank: usize) -> Self {
        Self { rank, positions: Vec::new(), faces: Vec::new(), displacements: Vec::new() }
    }

    /// Appends a primitive. `number` is its number in the mesh, `part` its name in messages.
    pub fn push(
        &mut self,
        accessors: &mut Accessors<'_>,
        number: usize,
        primitive: &Primitive,
        part: &str,
    ) -> Result<PrimitiveRange, FormatError> {
        let refused = |cause: String| FormatError::part(part, cause);
        let topology = Topology::from_mode(primitive.mode)
            .map_err(|kind| refused(format!("a primitive of triangles was expected, this one has {kind}")))?;
        let Some(base) = primitive.attributes.position else {
            return Err(refused("it has no positions".into()));
        };
        if primitive.extensions.is_compressed() {
            for accessor in [base].into_iter().chain(primitive.indices) {
                accessors.check_uncompressed(accessor, part)?;
            }
        }
        let count = accessors.count(base)?;
        take(accessors, count, 24 * (1 + self.rank as u64), part)?;
        let positions = vectors(&accessors.read(base, Role::Positions)?);
        let mut columns = Vec::new();
        for (k, target) in primitive.targets.iter().take(self.rank).enumerate() {
            // A target without positions only changes normals or colours.
            let Some(accessor) = target.position else {
                columns.push(Vec::new());
                continue;
            };
            let moved = accessors.count(accessor)?;
            if moved != count {
                return Err(refused(format!("target {k} has {moved} positions for {count} vertices")));
            }
            take(accessors, count, 24, part)?;
            columns.push(vectors(&accessors.read(accessor, Role::Positions)?));
        }
        let faces = faces_of(accessors, primitive, topology, count, part)?;
        let (v, t) = (self.positions.len(), self.faces.len());
        let range = |from: usize, more: usize| match (u32::try_from(from), u32::try_from(from + more)) {
            (Ok(begin), Ok(end)) => Ok(begin..end),
            _ => Err(refused(format!(
                "with it the mesh has {} vertices or triangles: 32-bit indices allow at most 2^32 - 1",
                from + more
            ))),
        };
        let (vertices, triangles) = (range(v, count)?, range(t, faces.len())?);
        let ranges = PrimitiveRange { number, vertices, triangles };
        let first = ranges.vertices.start;
        self.faces.extend(faces.iter().map(|face| face.map(|vertex| first + vertex)));
        self.positions.extend(&positions);
        columns.resize(self.rank, Vec::new());
        let columns = &columns;
        let rows =
            (0..count).flat_map(|v| columns.iter().map(move |c| c.get(v).copied().unwrap_or_default()));
        self.displacements.extend(rows);
        Ok(ranges)
    }
}

/// Returns the triangles of a primitive, with its own vertex numbers, which are below `count`.
fn faces_of(
    accessors: &mut Accessors<'_>,
    primitive: &Primitive,
    topology: Topology,
    count: usize,
    part: &str,
) -> Result<Vec<[u32; 3]>, FormatError> {
    let refused = |cause: String| FormatError::part(part, cause);
    let corners: Vec<u32> = match primitive.indices {
        Some(indices) => {
            // A strip has up to 12 bytes of a triangle for each corner, and lists are copied once.
            let corners = accessors.count(indices)?;
            take(accessors, corners, 28, part)?;
            accessors.read(indices, Role::Indices)?.into_iter().map(|index| index as u32).collect()
        }
        None => {
            take(accessors, count, 28, part)?;
            (0..u32::try_from(count).map_err(|_| {
                refused(format!("it has {count} vertices: 32-bit indices allow at most 2^32 - 1"))
            })?)
                .collect()
        }
    };
    if let Some(largest) = corners.iter().max().filter(|index| **index as usize >= count) {
        let cause = format!("an index names vertex {largest} (counted from 0), but there are {count}");
        return Err(refused(cause));
    }
    topology.triangles(&corners).ok_or_else(|| {
        refused(format!(
            "{} corners are no triangles: a list needs a multiple of 3, a strip or a fan at least 3",
            corners.len()
        ))
    })
}

fn take(accessors: &mut Accessors<'_>, count: usize, size: u64, part: &str) -> Result<(), FormatError> {
    accessors.allowance.take(count as u64, size).map_err(|cause| FormatError::part(part, cause))
}

fn vectors(values: &[f64]) -> Vec<DVec3> {
    values.as_chunks().0.iter().map(|xyz| DVec3::from_array(*xyz)).collect()
}
