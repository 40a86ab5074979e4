//! Deformation modes U, and the definition of the deformed shape that all answers refer to.

use glam::DVec3;

use crate::{Error, TriMesh, limits};

/// Deformation modes `U` (3V x r): the displacement of each vertex for a unit of each reduced
/// coordinate (model unit per unit of q). Any rank r >= 1 is valid; modes may be 0, equal or linearly dependent.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    rank: usize,
    /// The displacement of a vertex by a mode is `displacements[vertex * rank + mode]`.
    displacements: Vec<DVec3>,
}

impl Modes {
    /// Creates modes from displacements in vertex-major order: `displacements[vertex * rank + mode]`.
    ///
    /// # Errors
    /// When `rank` is 0 or more than 2^20, the number of displacements is not a multiple of it, or an entry is not finite or larger in
    /// magnitude than [`limits::LARGEST`].
    pub fn new(rank: usize, displacements: Vec<DVec3>) -> Result<Self, Error> {
        if rank == 0 {
            return Err(Error::RankZero);
        }
        if with_mutant!(rank > limits::MAX_MODES, ModesWithoutLimit, false) {
            let wanted = "at most 2^20 (1,048,576)";
            return Err(Error::Option { name: "the number of modes", value: rank as f64, wanted });
        }
        if !displacements.len().is_multiple_of(rank) {
            return Err(Error::ModesLength { len: displacements.len(), rank });
        }
        if let Some(index) = displacements.iter().position(|u| !limits::contains(*u)) {
            return Err(Error::ModeEntry { vertex: index / rank, mode: index % rank });
        }
        Ok(Self { rank, displacements })
    }

    /// Creates modes from a matrix, given by its entries `entry(3 * vertex + component, mode)`.
    ///
    /// # Errors
    /// As [`Modes::new`].
    pub fn from_matrix(
        vertices: usize,
        rank: usize,
        entry: impl Fn(usize, usize) -> f64,
    ) -> Result<Self, Error> {
        let displacements = (0..vertices)
            .flat_map(|i| (0..rank).map(move |k| (i, k)))
            .map(|(i, k)| DVec3::new(entry(3 * i, k), entry(3 * i + 1, k), entry(3 * i + 2, k)))
            .collect();
        Self::new(rank, displacements)
    }

    /// Returns the number of modes r.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Returns the number of vertices V.
    pub fn vertices(&self) -> usize {
        self.displacements.len() / self.rank
    }

    /// Returns the r displacements of one vertex, mode 0 first.
    ///
    /// # Panics
    /// When there is no such vertex.
    pub fn of_vertex(&self, vertex: u32) -> &[DVec3] {
        &self.displacements[vertex as usize * self.rank..][..self.rank]
    }

    /// Checks that the modes are for the vertices of a mesh.
    ///
    /// # Errors
    /// When the mesh has another number of vertices.
    pub(crate) fn check_mesh(&self, mesh: &TriMesh) -> Result<(), Error> {
        let (modes, mesh) = (self.vertices(), mesh.rest_positions().len());
        if modes == mesh { Ok(()) } else { Err(Error::VertexCount { modes, mesh }) }
    }

    /// Returns all displacements in vertex-major order: `[vertex * rank + mode]`.
    pub fn displacements(&self) -> &[DVec3] {
        &self.displacements
    }
}

/// Returns the deformed position of one vertex: `x = p`, then `x += U_k q_k` for k = 0 .. r-1 in this order, each
/// product and sum rounded once (no fused multiply-add). This function **defines** the shape: all methods, tests and
/// certificates refer to these f64 positions.
#[inline]
pub fn deformed_position(rest: DVec3, modes: &[DVec3], q: &[f64]) -> DVec3 {
    let mut x = rest;
    for (u, &q_k) in modes.iter().zip(q) {
        x += *u * q_k;
    }
    x
}
