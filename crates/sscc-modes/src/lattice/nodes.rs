//! Nodes of a lattice: corners of copies that coincide.

use glam::DVec3;
use sscc::parts::DisjointSets;

use super::cells::{Cells, NONE};
use super::copies::Copies;
use super::crossings::Interval;
use super::grid::Grid;
use super::overlap::{Block, SLACK};
use super::pieces::for_each_piece;
use super::surface::Surface;
use crate::ModesError;
use crate::interpolation::OCTANTS;

/// Common corners of a cube and the next one along each axis: the number in the cube, and in the next one.
const COMMON: [[[u32; 2]; 4]; 3] =
    [[[1, 0], [2, 3], [5, 4], [6, 7]], [[3, 0], [2, 1], [7, 4], [6, 5]], [[4, 0], [5, 1], [6, 2], [7, 3]]];

/// Nodes in order of their first use.
pub(super) struct Nodes {
    /// Positions (model unit).
    pub positions: Vec<DVec3>,
    /// Nodes at the corners of each copy.
    pub of_copy: Vec<[u32; 8]>,
}

impl Nodes {
    /// Creates the nodes. Copies in neighbouring cells share the corners of their common face if the solid or its surface
    /// passes this face.
    ///
    /// # Errors
    /// When the copies are not all connected.
    pub fn new(
        grid: &Grid,
        cells: &Cells,
        surface: &Surface,
        points: &[DVec3],
        inside: &[Vec<Interval>; 3],
        copies: &Copies,
    ) -> Result<Self, ModesError> {
        let mut corners = DisjointSets::new(8 * copies.cell.len());
        let mut connected = DisjointSets::new(copies.cell.len());
        let mut link = |axis: usize, elements: [u32; 2]| {
            let [a, b] = elements.map(|element| copies.of_element[element as usize]);
            connected.unite(a, b);
            for [high, low] in COMMON[axis] {
                corners.unite(8 * a + high, 8 * b + low);
            }
        };
        for axis in 0..3 {
            for_each_piece(grid, cells, axis, &inside[axis], |piece, last| {
                let ends = last.map(|last| [last, piece].map(|piece| piece.elements().next()));
                if let Some([Some(a), Some(b)]) = ends {
                    link(axis, [a, b]);
                }
            });
            for cell in 0..cells.len() {
                link_along_surface(grid, cells, surface, points, (cell, axis), &mut link);
            }
        }
        match connected.count() {
            1 => Ok(Self::number(grid, cells, copies, corners)),
            count => Err(ModesError::Pieces { count }),
        }
    }

    fn number(grid: &Grid, cells: &Cells, copies: &Copies, mut corners: DisjointSets) -> Self {
        let mut number = vec![NONE; 8 * copies.cell.len()];
        let mut nodes = Self { positions: Vec::new(), of_copy: Vec::with_capacity(copies.cell.len()) };
        for (copy, cell) in (0_u32..).zip(&copies.cell) {
            let low = grid.cell(cells.keys[*cell as usize]);
            nodes.of_copy.push(std::array::from_fn(|corner| {
                let node = &mut number[corners.find(8 * copy + corner as u32) as usize];
                if *node == NONE {
                    *node = nodes.positions.len() as u32;
                    let place = OCTANTS[corner];
                    nodes.positions.push(grid.position(std::array::from_fn(|k| low[k] + place[k])));
                }
                *node
            }));
        }
        nodes
    }
}

/// Links the patches of a cell with those of the next cell which share a triangle that passes the face between.
fn link_along_surface(
    grid: &Grid,
    cells: &Cells,
    surface: &Surface,
    points: &[DVec3],
    (cell, axis): (usize, usize),
    link: &mut impl FnMut(usize, [u32; 2]),
) {
    let next = cells.next[cell][axis];
    if next == NONE {
        return;
    }
    let mut low = grid.cell(cells.keys[cell]);
    let high = low.map(|i| i + 1);
    low[axis] += 1;
    // The slack is larger than that of triangles, so a triangle that reaches both cells only by their slack passes.
    let face = Block::cells(low, high).enlarged(2.0 * SLACK);
    for (number, triangle) in cells.triangles(cell).iter().enumerate() {
        if let Some(other) = cells.find_triangle(next as usize, *triangle)
            && face.meets_triangle(surface.faces[*triangle as usize].map(|v| points[v as usize]))
        {
            link(axis, [cells.triangle_element(cell, number), other]);
        }
    }
}
