//! Interpolation from the vertices of a solid to those of a surface that moves with it.

use glam::DVec3;

/// The corners of a cube in the order of a solid's cubes: 000, 100, 110, 010, 001, 101, 111, 011 (x, y, z).
pub(crate) const OCTANTS: [[u32; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// Weights of surface vertices: each is a weighted mean of at most eight vertices of its element.
pub(crate) struct Interpolation {
    /// Vertices of the solid and weights of each vertex of the surface. Weights have the sum 1; only those of a vertex
    /// outside its element may be negative. A vertex without faces has weights 0 and does not move.
    pub vertices: Vec<[(u32, f64); 8]>,
}

impl Interpolation {
    /// Interpolates a field at the vertices of the solid.
    pub fn apply(&self, field: &[DVec3]) -> Vec<DVec3> {
        let value = |weights: &[(u32, f64); 8]| {
            weights.iter().fold(DVec3::ZERO, |sum, (vertex, weight)| sum + *weight * field[*vertex as usize])
        };
        self.vertices.iter().map(value).collect()
    }
}
