//! A cube for each piece, and which corners they share.

use glam::DVec3;

use super::LEAST_FILL;
use super::grid::{Grid, SAMPLES};
use super::lines::Lines;
use super::overlap::triangle_box;
use super::pieces::{Part, Pieces, cell_box};
use super::surface::Surface;
use super::union::Union;
use crate::ModesError;

/// The corners of a cell, in the order of [`Solid::cubes`](crate::Solid::cubes).
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];

/// No cube.
const NONE: u32 = u32::MAX;

/// The cubes of a lattice.
pub(super) struct Cubes {
    pub vertices: Vec<DVec3>,
    pub cubes: Vec<[u32; 8]>,
    pub fill: Vec<[f64; 8]>,
    /// The cube of each piece, by its least element.
    pub cube_of_piece: Vec<u32>,
}

impl Cubes {
    /// # Errors
    /// When they are not all connected.
    pub fn new(surface: &Surface, grid: &Grid, lines: &Lines, pieces: &Pieces) -> Result<Self, ModesError> {
        let (cube_of_piece, cells) = number(grid, pieces);
        let cube_of = |element: u32| cube_of_piece[pieces.piece[element as usize] as usize];
        let mut corners = Union::new(8 * cells.len());
        let mut fill = vec![[0.0; 8]; cells.len()];
        lines.each(grid, |axis, across, stretch| {
            let mut before: Option<u32> = None;
            pieces.parts(grid, axis, across, stretch, |part| {
                let cube = part.element.map(cube_of);
                if let (Some(a), Some(b)) = (before, cube) {
                    glue(&mut corners, a, b, axis);
                }
                if let Some(cube) = cube {
                    add_fill(grid, axis, across, &part, &mut fill[cube as usize]);
                }
                before = cube;
            });
        });
        for (index, (cell, face)) in pieces.triangles.iter().enumerate() {
            let place = grid.place(*cell as usize);
            for axis in 0..3 {
                let mut next = place;
                next[axis] += 1;
                if next[axis] == grid.size[axis] {
                    continue;
                }
                let Some(other) = pieces.triangle(grid, grid.cell(next), *face) else { continue };
                // The face between the two cells, a little thick.
                let (mut centre, mut half) = cell_box(grid, *cell as usize);
                centre[axis] += 0.5 * grid.spacing;
                half[axis] *= 1e-6;
                if triangle_box(surface.corners(*face), centre, half) {
                    glue(&mut corners, cube_of((grid.samples() + index) as u32), cube_of(other), axis);
                }
            }
        }
        fill.iter_mut().flatten().for_each(|share| *share = share.clamp(LEAST_FILL, 1.0));

        let mut vertices = Vec::new();
        let mut vertex_of = vec![NONE; 8 * cells.len()];
        let mut cubes = vec![[NONE; 8]; cells.len()];
        for (cube, cell) in cells.iter().enumerate() {
            let place = grid.place(*cell as usize);
            for (k, corner) in CORNERS.iter().enumerate() {
                let root = corners.find((8 * cube + k) as u32) as usize;
                if vertex_of[root] == NONE {
                    vertex_of[root] = vertices.len() as u32;
                    vertices.push(grid.corner([0, 1, 2].map(|axis| place[axis] + corner[axis])));
                }
                cubes[cube][k] = vertex_of[root];
            }
        }
        let mut connected = Union::new(vertices.len());
        cubes.iter().for_each(|cube| cube.iter().for_each(|v| connected.join(cube[0], *v)));
        let count = (0..vertices.len() as u32).filter(|v| connected.find(*v) == *v).count();
        if count > 1 {
            return Err(ModesError::Pieces { count });
        }
        Ok(Self { vertices, cubes, fill, cube_of_piece })
    }
}

/// Numbers the pieces: cell by cell, samples first. The cube of each piece, and the cell of each cube.
fn number(grid: &Grid, pieces: &Pieces) -> (Vec<u32>, Vec<u32>) {
    let mut cube_of_piece = vec![NONE; pieces.piece.len()];
    let mut cells = Vec::new();
    let mut triangles = pieces.triangles.iter().enumerate().peekable();
    for cell in 0..grid.cells() {
        let place = grid.place(cell);
        let mut add = |element: usize| {
            let piece = pieces.piece[element] as usize;
            if cube_of_piece[piece] == NONE {
                cube_of_piece[piece] = cells.len() as u32;
                cells.push(cell as u32);
            }
        };
        for k in 0..SAMPLES * SAMPLES * SAMPLES {
            let within = [k % SAMPLES, k / SAMPLES % SAMPLES, k / (SAMPLES * SAMPLES)];
            let sample = grid.sample([0, 1, 2].map(|axis| place[axis] * SAMPLES + within[axis]));
            if pieces.inside[sample] {
                add(sample);
            }
        }
        while let Some((index, _)) = triangles.next_if(|(_, (of, _))| *of as usize == cell) {
            add(grid.samples() + index);
        }
    }
    (cube_of_piece, cells)
}

/// Lets two cubes share the face that is the upper one of `a` and the lower one of `b` along an axis.
fn glue(corners: &mut Union, a: u32, b: u32, axis: usize) {
    for (k, corner) in CORNERS.iter().enumerate().filter(|(_, corner)| corner[axis] == 1) {
        let mut below = *corner;
        below[axis] = 0;
        if let Some(j) = CORNERS.iter().position(|c| *c == below) {
            corners.join(8 * a + k as u32, 8 * b + j as u32);
        }
    }
}

/// Adds the share of the cell's octants that a part of a line stands for.
fn add_fill(grid: &Grid, axis: usize, across: [usize; 2], part: &Part, fill: &mut [f64; 8]) {
    let low = grid.low[axis] + grid.spacing * part.cell[axis] as f64;
    let half = 0.5 * grid.spacing;
    // An octant has (SAMPLES / 2)^2 lines along each of three axes.
    let weight = 1.0 / (3.0 * (SAMPLES * SAMPLES / 4) as f64 * half);
    let upper = across.map(|k| usize::from(k % SAMPLES >= SAMPLES / 2));
    for side in 0..2 {
        let from = low + half * side as f64;
        let length = (part.ends[1].min(from + half) - part.ends[0].max(from)).max(0.0);
        let mut octant = [0; 3];
        octant[axis] = side;
        octant[(axis + 1) % 3] = upper[0];
        octant[(axis + 2) % 3] = upper[1];
        if let Some(k) = CORNERS.iter().position(|c| *c == octant) {
            fill[k] += weight * length;
        }
    }
}

/// The cube of each surface vertex, and the shares of its corners.
pub(super) fn interpolate(
    surface: &Surface,
    grid: &Grid,
    pieces: &Pieces,
    cube_of_piece: &[u32],
) -> Vec<Option<(u32, [f64; 8])>> {
    let mut places = vec![None; surface.points.len()];
    for (face, corners) in surface.faces.iter().enumerate() {
        for v in corners.map(|v| v as usize) {
            if places[v].is_some() {
                continue;
            }
            let p = surface.points[v];
            let at = [0, 1, 2].map(|axis| grid.cell_along(axis, p[axis]));
            let Some(element) = pieces.triangle(grid, grid.cell(at), face as u32) else { continue };
            let local = ((p - grid.corner(at)) / grid.spacing).clamp(DVec3::ZERO, DVec3::ONE);
            let share = |corner: [usize; 3]| {
                (0..3).map(|k| if corner[k] == 1 { local[k] } else { 1.0 - local[k] }).product::<f64>()
            };
            places[v] = Some((cube_of_piece[pieces.piece[element as usize] as usize], CORNERS.map(share)));
        }
    }
    places
}
