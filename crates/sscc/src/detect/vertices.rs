//! What vertices need to move, side by side in the order in which queries meet them.

use glam::DVec3;

use crate::ReducedModel;

/// Rest positions and modes of the vertices of triangles. In the order of the mesh, the vertices of a cluster lie far
/// apart.
#[derive(Default)]
pub(crate) struct Vertices {
    rank: usize,
    /// For each vertex of the mesh its place here; `u32::MAX` where no triangle has it.
    places: Vec<u32>,
    /// For each place its vertex.
    order: Vec<u32>,
    rest: Vec<DVec3>,
    /// `[place * rank + mode]`
    modes: Vec<DVec3>,
}

impl Vertices {
    /// In the order of this list, which may name a vertex more than once.
    pub(crate) fn new(model: &ReducedModel, order: &[u32]) -> Self {
        let (all, rank) = (model.mesh().rest_positions(), model.rank());
        let mut places = vec![u32::MAX; all.len()];
        let mut numbers = Vec::with_capacity(all.len());
        let mut rest = Vec::with_capacity(all.len());
        let mut modes = Vec::with_capacity(all.len() * rank);
        for &v in order {
            let place = &mut places[v as usize];
            if *place == u32::MAX {
                *place = rest.len() as u32;
                numbers.push(v);
                rest.push(all[v as usize]);
                modes.extend_from_slice(model.modes().of_vertex(v));
            }
        }
        Self { rank, places, order: numbers, rest, modes }
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.rest.len()
    }

    /// The place of a vertex of the mesh.
    #[inline]
    pub(crate) fn place(&self, vertex: u32) -> u32 {
        self.places[vertex as usize]
    }

    /// The vertex of the mesh at a place.
    pub(crate) fn vertex(&self, place: u32) -> u32 {
        self.order[place as usize]
    }

    /// Where the vertex at a place is at rest.
    pub(crate) fn rest(&self, place: u32) -> DVec3 {
        self.rest[place as usize]
    }

    /// Its displacements.
    pub(crate) fn modes(&self, place: u32) -> &[DVec3] {
        &self.modes[place as usize * self.rank..][..self.rank]
    }

    /// The position of the vertex at a place: to the bit that of [`deformed_position`](crate::deformed_position), at
    /// each q.
    #[inline]
    pub(crate) fn position<const E: usize>(&self, place: u32, q: [&[f64]; E]) -> [DVec3; E] {
        let mut x = [self.rest(place); E];
        let modes = self.modes(place);
        let q = q.map(|q| &q[..modes.len()]);
        // One pass over the modes for both ends.
        for (k, u) in modes.iter().enumerate() {
            for end in 0..E {
                x[end] += *u * q[end][k];
            }
        }
        x
    }
}
