//! Rest positions and modes of vertices, stored in the order in which queries read them.

use glam::DVec3;

use super::moving_modes::MovingModes;
use crate::ReducedModel;
use crate::vectors::InstructionSet;

/// Modes are listed for each vertex if at most one of this many displacements is not zero. With more nonzero ones, quantized
/// displacements by all modes take less time.
const LISTED_SHARE: usize = 4;

/// Rest positions and modes of the used vertices, bucket by bucket. In the order of the mesh the vertices of a bucket would be
/// far apart in memory. The index of a vertex in this store is not its number in the mesh.
#[derive(Default)]
pub(crate) struct VertexStore {
    /// For each vertex of the mesh its index here; `u32::MAX` for an unused vertex.
    indices: Vec<u32>,
    /// For each index the vertex of the mesh.
    mesh_vertices: Vec<u32>,
    rest: Vec<DVec3>,
    moving: MovingModes,
    /// For each vertex the displacements by the modes that move it.
    modes: Vec<DVec3>,
}

impl VertexStore {
    /// Stores vertices in the order of this list of mesh vertices, which may contain a vertex more than once.
    pub(crate) fn new(model: &ReducedModel, order: &[u32]) -> Self {
        let (all, rank) = (model.mesh().rest_positions(), model.rank());
        let Self { indices, mesh_vertices, .. } = Self::without_modes(all.len(), order);
        let of_vertex = |v: &u32| model.modes().of_vertex(*v);
        let is_zero = |u: &DVec3| *u == DVec3::ZERO;
        let zeros: usize =
            mesh_vertices.iter().map(|v| of_vertex(v).iter().filter(|u| is_zero(u)).count()).sum();
        let count = mesh_vertices.len() * rank;
        let moving = if (count - zeros) * LISTED_SHARE <= count {
            let lists = mesh_vertices.iter().map(|v| {
                // A sum that begins with -0 becomes 0 when a zero is added, so that vertices with -0 need all modes.
                let is_negative_zero = |x: f64| x == 0.0 && x.is_sign_negative();
                let are_all = all[*v as usize].to_array().into_iter().any(is_negative_zero);
                let modes = (0..rank as u32).zip(of_vertex(v));
                modes.filter(|(_, u)| are_all || !is_zero(u)).map(|(k, _)| k).collect()
            });
            MovingModes::listed(rank, lists)
        } else {
            MovingModes::all(rank)
        };
        let mut modes = Vec::with_capacity(if moving.are_listed() { count - zeros } else { count });
        for (index, v) in mesh_vertices.iter().enumerate() {
            match moving.list(index as u32) {
                Some(list) => modes.extend(list.iter().map(|k| of_vertex(v)[*k as usize])),
                None => modes.extend_from_slice(of_vertex(v)),
            }
        }
        let rest = mesh_vertices.iter().map(|v| all[*v as usize]).collect();
        Self { indices, mesh_vertices, rest, moving, modes }
    }

    /// Stores the order of vertices whose positions will be given, without rest positions and modes. `all`: the number of
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

    /// Returns the number of vertices.
    pub(crate) fn count(&self) -> usize {
        self.mesh_vertices.len()
    }

    /// Returns for each index the vertex of the mesh.
    pub(crate) fn mesh_vertices(&self) -> &[u32] {
        &self.mesh_vertices
    }

    /// Returns the index of a vertex of the mesh.
    #[inline]
    pub(crate) fn index_of(&self, mesh_vertex: u32) -> u32 {
        self.indices[mesh_vertex as usize]
    }

    /// Returns the vertex of the mesh that has this index.
    pub(crate) fn mesh_vertex(&self, index: u32) -> u32 {
        self.mesh_vertices[index as usize]
    }

    /// Returns the rest position of a vertex.
    pub(crate) fn rest(&self, index: u32) -> DVec3 {
        self.rest[index as usize]
    }

    /// Returns the modes that move each vertex, by its index.
    pub(crate) fn moving_modes(&self) -> &MovingModes {
        &self.moving
    }

    /// Returns the displacements of a vertex by the modes that move it.
    pub(crate) fn modes(&self, index: u32) -> &[DVec3] {
        &self.modes[self.moving.range(index)]
    }

    /// Prefetches the rest position and the modes of a vertex.
    #[inline]
    pub(crate) fn prefetch(&self, index: u32, instructions: InstructionSet) {
        instructions.prefetch(&self.rest[index as usize..=index as usize]);
        instructions.prefetch(self.modes(index));
    }

    /// Returns the position of a vertex at each q, bit for bit that of [`deformed_position`](crate::deformed_position).
    #[inline]
    pub(crate) fn position<const E: usize>(&self, index: u32, q: [&[f64]; E]) -> [DVec3; E] {
        let mut x = [self.rest(index); E];
        let modes = self.modes(index);
        if let Some(list) = self.moving.list(index) {
            for (k, u) in list.iter().zip(modes) {
                for end in 0..E {
                    x[end] += *u * q[end][with_mutant!(*k as usize, MovingModesAreFirst, 0)];
                }
            }
            return x;
        }
        let q = q.map(|q| &q[..modes.len()]);
        // One pass over the modes computes the positions at both configurations.
        for (k, u) in modes.iter().enumerate() {
            for end in 0..E {
                x[end] += *u * q[end][k];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;
    use crate::{Modes, TriMesh, deformed_position};

    /// In the models none to most displacements are zero; some vertices are not moved by any mode, and some rest positions are 0
    /// of either sign.
    #[test]
    fn positions_are_those_of_all_modes_bit_for_bit() {
        let random = &mut Random(41);
        let mut listed = [0; 2];
        for case in 0..60 {
            let (rank, every): (usize, usize) = ([1, 8, 30][case % 3], [1, 2, 3, 4, 5, 9][case / 3 % 6]);
            let signed_zero = |x: f64| if x.abs() < 0.3 { 0.0 * x } else { x };
            let rest: Vec<DVec3> =
                (0..40).map(|_| DVec3::from_array(random.vector().to_array().map(signed_zero))).collect();
            let modes: Vec<DVec3> = (0..40 * rank)
                .map(|i| {
                    let is_zero = i / rank % 7 == 3 || !(i / rank + i % rank).is_multiple_of(every);
                    if is_zero { DVec3::ZERO * random.signed() } else { random.vector() }
                })
                .collect();
            let faces = (0..38).map(|i| [i, i + 1, i + 2]).collect();
            let mesh = TriMesh::new(rest, faces).unwrap();
            let model = ReducedModel::new(mesh, Modes::new(rank, modes).unwrap()).unwrap();
            let order: Vec<u32> = (0..40).rev().chain(0..40).collect();
            let store = VertexStore::new(&model, &order);
            listed[usize::from(store.moving_modes().are_listed())] += 1;
            let [a, b]: [Vec<f64>; 2] = std::array::from_fn(|_| (0..rank).map(|_| random.signed()).collect());
            for v in 0..40 {
                let expected = [&a, &b].map(|q| {
                    let x = deformed_position(
                        model.mesh().rest_positions()[v],
                        model.modes().of_vertex(v as u32),
                        q,
                    );
                    x.to_array().map(f64::to_bits)
                });
                let index = store.index_of(v as u32);
                let found = store.position(index, [&a, &b]).map(|x| x.to_array().map(f64::to_bits));
                assert_eq!(found, expected, "case {case}");
                assert_eq!(store.position(index, [&a])[0].to_array().map(f64::to_bits), expected[0]);
            }
        }
        assert!(listed[0] > 20 && listed[1] > 15, "{listed:?}");
    }
}
