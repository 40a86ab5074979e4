//! A solid around a closed surface: a lattice of cubes.
//!
//! A cube of the lattice may hold several pieces of the shape that are close in space but apart along it: an ear on the
//! back, a coil of a spring and the next, two lips. Each connected piece gets a cube of its own, so that nothing is glued
//! that is not one (after Nesme, Kry, Jerabkova and Faure 2009). How pieces are told apart is in [`pieces`]; which part of
//! a cube is filled is measured along lines ([`lines`]).

mod cubes;
mod grid;
mod lines;
mod overlap;
mod pieces;
mod surface;
mod union;

use glam::DVec3;
use sscc::TriMesh;

use crate::ModesError;
use cubes::{Cubes, interpolate};
use grid::Grid;
use lines::Lines;
use pieces::Pieces;
use surface::Surface;

/// Cubes that the volume of the shape would fill, if nothing else is asked for. The first ten frequencies of the bunny
/// are then within 5% of those at twice the resolution.
const FILLED_CUBES: f64 = 10_000.0;

/// The least share of an octant that counts as filled. Cubes that the surface only touches need some stiffness, and a
/// thousandth changes no frequency by more than the rest of the discretisation does.
const LEAST_FILL: f64 = 1e-3;

/// A lattice around a surface.
pub(crate) struct Lattice {
    /// Corners of the cubes.
    pub vertices: Vec<DVec3>,
    /// Each cube's corners, ordered as in [`Solid::cubes`](crate::Solid::cubes).
    pub cubes: Vec<[u32; 8]>,
    /// The share of each cube's octants that lies inside the surface.
    pub fill: Vec<[f64; 8]>,
    /// For each vertex of the surface, the cube that it moves with and the shares of the cube's corners; none where no
    /// triangle uses it.
    pub places: Vec<Option<(u32, [f64; 8])>>,
    /// Length of an edge of a cube (model unit).
    pub spacing: f64,
}

impl Lattice {
    /// `cells` is the number of cubes along the longest side; if not given, 10,000 cubes have the volume of the shape.
    ///
    /// # Errors
    /// When the surface is open, meets itself, encloses no volume or is in several pieces, or there are too many cubes.
    pub fn around(mesh: &TriMesh, cells: Option<usize>) -> Result<Self, ModesError> {
        let surface = Surface::new(mesh)?;
        let grid = Grid::new(&surface, cells, FILLED_CUBES)?;
        let lines = Lines::through(&surface, &grid);
        let pieces = Pieces::new(&surface, &grid, &lines);
        let Cubes { vertices, cubes, fill, cube_of_piece } = Cubes::new(&surface, &grid, &lines, &pieces)?;
        let places = interpolate(&surface, &grid, &pieces, &cube_of_piece);
        Ok(Self { vertices, cubes, fill, places, spacing: grid.spacing })
    }
}

#[cfg(test)]
mod tests;
