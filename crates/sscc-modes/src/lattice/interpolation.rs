//! Interpolation from the nodes of a lattice to the vertices of the surface.

use glam::DVec3;

use super::cells::Cells;
use super::copies::{Copies, OCTANTS};
use super::grid::Grid;
use super::surface::Surface;

/// Each surface vertex is a trilinear mean of the 8 nodes of the cube that it lies in.
pub(crate) struct Interpolation {
    /// For each vertex the nodes and their weights, which are positive and have the sum 1. A vertex that no face
    /// uses has the weights 0: it does not move.
    pub vertices: Vec<[(u32, f64); 8]>,
}

impl Interpolation {
    /// The weights for vertices (in units of cells), in the copy in which their triangles are.
    pub(super) fn new(
        grid: &Grid,
        cells: &Cells,
        surface: &Surface,
        points: &[DVec3],
        copies: &Copies,
        nodes: &[[u32; 8]],
    ) -> Self {
        let mut vertices = vec![[(0, 0.0); 8]; points.len()];
        let mut is_done = vec![false; points.len()];
        for (triangle, face) in (0_u32..).zip(&surface.faces) {
            for v in face.map(|v| v as usize) {
                if is_done[v] {
                    continue;
                }
                let low = grid.cell_of(points[v]);
                let element = cells.find(grid.key(low)).and_then(|cell| cells.find_triangle(cell, triangle));
                // Always found: the triangle has a point there.
                let Some(element) = element else { continue };
                is_done[v] = true;
                let cube = nodes[copies.of_element[element as usize] as usize];
                let at = points[v] - DVec3::from_array(low.map(f64::from));
                vertices[v] = std::array::from_fn(|k| {
                    let share = |axis: usize| if OCTANTS[k][axis] == 1 { at[axis] } else { 1.0 - at[axis] };
                    (cube[k], share(0) * share(1) * share(2))
                });
            }
        }
        Self { vertices }
    }

    /// The vertices' values of a field given at the nodes.
    pub fn apply(&self, field: &[DVec3]) -> Vec<DVec3> {
        let value = |weights: &[(u32, f64); 8]| {
            weights.iter().fold(DVec3::ZERO, |sum, (node, weight)| sum + *weight * field[*node as usize])
        };
        self.vertices.iter().map(value).collect()
    }
}
