//! Embeds a closed surface in a lattice of cubes for finite elements; no tetrahedra are needed.
//!
//! The lattice keeps parts separate that are close in space but not along the surface, for example neighbouring coils
//! of a spring. If a cell of the grid contains several pieces of the solid that are not connected within it, each has
//! a copy of the cell with its own nodes (Molino, Bao and Fedkiw 2004, "A virtual node algorithm"; Nesme et al. 2009,
//! "Preserving topology and elasticity for embedded deformable models"). Two criteria decide connectivity:
//! - lines through the solid, 16 through each cell along each axis: an inside interval is one piece, however thin, and
//!   a gap separates two pieces, however narrow;
//! - the surface: triangles that share an edge within a cell belong to one piece.

use glam::DVec3;
use sscc::{Progress, TriMesh};

use crate::ModesError;
use crate::cancel::check_cancelled;
use crate::interpolation::Interpolation;
use cells::Cells;
use copies::Copies;
use crossings::intervals;
use grid::Grid;
use nodes::Nodes;
use orientation::check_orientation;
use surface::{Surface, check_rest};

mod cells;
mod copies;
mod crossings;
mod grid;
mod interpolation;
mod nodes;
mod orientation;
mod overlap;
mod pieces;
mod probe;
mod surface;
#[cfg(test)]
mod tests;

/// Steps of the work, for progress.
const STEPS: usize = 7;

/// Cubes around a solid, some of them copies of the same cell.
pub(crate) struct Lattice {
    /// Positions of the nodes (model unit).
    pub vertices: Vec<DVec3>,
    /// Nodes at the corners 000, 100, 110, 010, 001, 101, 111, 011 (x, y, z) of each cube.
    pub cubes: Vec<[u32; 8]>,
    /// Filled share of each octant of each cube (octant k is at corner k): at least 1e-3, so that every octant has mass
    /// and stiffness.
    pub fill: Vec<[f64; 8]>,
    /// Side of a cube (model unit).
    pub spacing: f64,
    /// Interpolation from the nodes to the surface.
    pub interpolation: Interpolation,
    /// Whether the surface is closed only when vertices of equal position are one.
    pub is_split: bool,
}

impl Lattice {
    /// Creates the lattice around the solid within a closed surface, with `cells` cubes along its longest side; None
    /// gives about 20,000 cubes in all, or fewer if triangles meet too many cells. Cubes are in the order of cells, x fastest, and nodes in the order of first use.
    ///
    /// # Errors
    /// When the surface is open, not consistently oriented, without volume, collides with itself or has several pieces;
    /// when a part of it lies inside the solid or is inside out; when the resolution is 0 or needs too much memory;
    /// when cancelled.
    pub fn around(mesh: &TriMesh, cells: Option<usize>, progress: &dyn Progress) -> Result<Self, ModesError> {
        let step = |done: usize| {
            progress.report(done, STEPS);
            check_cancelled(progress)
        };
        step(0)?;
        let surface = Surface::new(mesh)?;
        let grid = Grid::around(&surface, cells)?;
        check_rest(mesh, surface.is_split, progress)?;
        step(1)?;
        let points: Vec<DVec3> = mesh.rest_positions().iter().map(|p| grid.coordinates(*p)).collect();
        let (mut inside, mut odd) = ([const { Vec::new() }; 3], Vec::new());
        for axis in 0..3 {
            inside[axis] = intervals(axis, &points, &surface.faces, &mut odd, progress)?;
            step(2 + axis)?;
        }
        check_orientation(&surface, &inside, &odd)?;
        let cells = Cells::new(&grid, &points, &surface.faces, &inside[0], progress)?;
        step(5)?;
        let copies = Copies::new(&grid, &cells, &surface, &points, &inside, progress)?;
        step(6)?;
        let nodes = Nodes::new(&grid, &cells, &surface, &points, &inside, &copies)?;
        let interpolation = Interpolation::new(&grid, &cells, &surface, &points, &copies, &nodes.of_copy);
        step(STEPS)?;
        Ok(Self {
            vertices: nodes.positions,
            cubes: nodes.of_copy,
            fill: copies.fill,
            spacing: grid.spacing,
            interpolation,
            is_split: surface.is_split,
        })
    }
}
