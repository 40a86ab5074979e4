//! Weights of the nodes of a lattice at the vertices of the surface: trilinear in each cube.

use glam::DVec3;

use super::cells::Cells;
use super::copies::Copies;
use super::grid::Grid;
use super::surface::Surface;
use crate::interpolation::{Interpolation, OCTANTS};

impl Interpolation {
    /// Computes the weights of vertices (in units of cells), in the copies that contain their triangles.
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
                // The triangle meets this cell, so the element exists.
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
}
