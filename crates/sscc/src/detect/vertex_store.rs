//! Rest positions and modes of vertices, stored in the order in which queries read them.

use glam::DVec3;

use crate::ReducedModel;
use crate::vectors::InstructionSet;

/// Rest positions and modes of the used vertices, bucket by bucket. In the order of the mesh the vertices of a bucket lie
/// far apart in memory. A vertex is named by its index in this store, which is not its number in the mesh.
#[derive(Default)]
pub(crate) struct VertexStore {
    rank: usize,
    /// For each vertex of the mesh its index here; `u32::MAX` for an unused vertex.
    indices: Vec<u32>,
    /// For each index the vertex of the mesh.
    mesh_vertices: Vec<u32>,
    rest: Vec<DVec3>,
    /// `[index * rank + mode]`
    modes: Vec<DVec3>,
}

impl VertexStore {
    /// Stores vertices in the order of this list of mesh vertices, which may name a vertex more than once.
    pub(crate) fn new(model: &ReducedModel, order: &[u32]) -> Self {
        let (all, rank) = (model.mesh().rest_positions(), model.rank());
        let mut indices = vec![u32::MAX; all.len()];
        let mut mesh_vertices = Vec::with_capacity(all.len());
        let mut rest = Vec::with_capacity(all.len());
        let mut modes = Vec::with_capacity(all.len() * rank);
        for &v in order {
            let index = &mut indices[v as usize];
            if *index == u32::MAX {
                *index = rest.len() as u32;
                mesh_vertices.push(v);
                rest.push(all[v as usize]);
                modes.extend_from_slice(model.modes().of_vertex(v));
            }
        }
        Self { rank, indices, mesh_vertices, rest, modes }
    }

    /// The same for vertices whose positions will be given: neither rest positions nor modes are stored. `all`: the number of
    /// vertices of the mesh.
    pub(crate) fn without_modes(all: usize, order: &[u32]) -> Self {
        let mut indices = vec![u32::MAX; all];
        let mut mesh_vertices = Vec::new();
        for &v in order {
            let index = &mut indices[v as usize];
            if *index == u32::MAX {
                *index = mesh_vertices.len() as u32;
                mesh_vertices.push(v);
            }
        }
        Self { rank: 0, indices, mesh_vertices, rest: Vec::new(), modes: Vec::new() }
    }

    /// The number of vertices.
    pub(crate) fn count(&self) -> usize {
        self.mesh_vertices.len()
    }

    /// For each index the vertex of the mesh.
    pub(crate) fn mesh_vertices(&self) -> &[u32] {
        &self.mesh_vertices
    }

    /// The index of a vertex of the mesh.
    #[inline]
    pub(crate) fn index_of(&self, mesh_vertex: u32) -> u32 {
        self.indices[mesh_vertex as usize]
    }

    /// The vertex of the mesh that has this index.
    pub(crate) fn mesh_vertex(&self, index: u32) -> u32 {
        self.mesh_vertices[index as usize]
    }

    /// The rest position of a vertex.
    pub(crate) fn rest(&self, index: u32) -> DVec3 {
        self.rest[index as usize]
    }

    /// The displacements of a vertex by each mode.
    pub(crate) fn modes(&self, index: u32) -> &[DVec3] {
        &self.modes[index as usize * self.rank..][..self.rank]
    }

    /// Prefetches the rest position and the modes of a vertex.
    #[inline]
    pub(crate) fn prefetch(&self, index: u32, instructions: InstructionSet) {
        instructions.prefetch(&self.rest[index as usize..=index as usize]);
        instructions.prefetch(self.modes(index));
    }

    /// The position of a vertex at each q, bit for bit that of [`deformed_position`](crate::deformed_position).
    #[inline]
    pub(crate) fn position<const E: usize>(&self, index: u32, q: [&[f64]; E]) -> [DVec3; E] {
        let mut x = [self.rest(index); E];
        let modes = self.modes(index);
        let q = q.map(|q| &q[..modes.len()]);
        // One pass over the modes serves both configurations.
        for (k, u) in modes.iter().enumerate() {
            for end in 0..E {
                x[end] += *u * q[end][k];
            }
        }
        x
    }
}
