//! Rest positions and modes of vertices, stored in the order in which queries read them.

use glam::DVec3;

use super::mode_lists::ModeLists;
use crate::ReducedModel;
use crate::vectors::InstructionSet;

/// Modes are listed for each vertex where at most one in so many displacements is not zero.
const SHARE_OF_LISTS: usize = 2;

/// Rest positions and modes of the used vertices, bucket by bucket. In the order of the mesh the vertices of a bucket lie
/// far apart in memory. A vertex is named by its index in this store, which is not its number in the mesh.
#[derive(Default)]
pub(crate) struct VertexStore {
    /// For each vertex of the mesh its index here; `u32::MAX` for an unused vertex.
    indices: Vec<u32>,
    /// For each index the vertex of the mesh.
    mesh_vertices: Vec<u32>,
    rest: Vec<DVec3>,
    /// The modes that move each vertex.
    lists: ModeLists,
    /// Of each vertex the displacements by its modes.
    modes: Vec<DVec3>,
}

impl VertexStore {
    /// Stores vertices in the order of this list of mesh vertices, which may name a vertex more than once.
    pub(crate) fn new(model: &ReducedModel, order: &[u32]) -> Self {
        let (all, rank) = (model.mesh().rest_positions(), model.rank());
        let is_moving = |u: &DVec3| *u != DVec3::ZERO;
        let moving = model.modes().displacements().iter().filter(|u| is_moving(u)).count();
        let has_lists = moving <= model.modes().displacements().len() / SHARE_OF_LISTS;
        let mut indices = vec![u32::MAX; all.len()];
        let mut mesh_vertices = Vec::with_capacity(all.len());
        let mut rest = Vec::with_capacity(all.len());
        let (mut lists, mut modes) = (Vec::new(), Vec::new());
        for &v in order {
            let index = &mut indices[v as usize];
            if *index == u32::MAX {
                *index = rest.len() as u32;
                mesh_vertices.push(v);
                rest.push(all[v as usize]);
                let of_vertex = model.modes().of_vertex(v);
                if has_lists {
                    let own = || (0..rank as u32).zip(of_vertex).filter(|(_, u)| is_moving(u));
                    lists.push(own().map(|(k, _)| k).collect());
                    modes.extend(own().map(|(_, u)| *u));
                } else {
                    modes.extend_from_slice(of_vertex);
                }
            }
        }
        let lists =
            if has_lists { ModeLists::of_lists(rank, lists.into_iter()) } else { ModeLists::all(rank) };
        Self { indices, mesh_vertices, rest, lists, modes }
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
        Self { indices, mesh_vertices, ..Self::default() }
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

    /// The modes that move each vertex.
    pub(crate) fn lists(&self) -> &ModeLists {
        &self.lists
    }

    /// The displacements of a vertex by the modes of its list.
    pub(crate) fn modes(&self, index: u32) -> &[DVec3] {
        &self.modes[self.lists.range(index)]
    }

    /// Prefetches the rest position and the modes of a vertex.
    #[inline]
    pub(crate) fn prefetch(&self, index: u32, instructions: InstructionSet) {
        instructions.prefetch(&self.rest[index as usize..=index as usize]);
        instructions.prefetch(self.modes(index));
    }

    /// The position of a vertex at each q, that of [`deformed_position`](crate::deformed_position): bit for bit, but for the sign of
    /// zeros.
    #[inline]
    pub(crate) fn position<const E: usize>(&self, index: u32, q: [&[f64]; E]) -> [DVec3; E] {
        let mut x = [self.rest(index); E];
        let modes = self.modes(index);
        if let Some(list) = self.lists.list(index) {
            for (k, u) in list.iter().zip(modes) {
                for end in 0..E {
                    x[end] += *u * q[end][*k as usize];
                }
            }
            return x;
        }
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
