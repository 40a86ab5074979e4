//! The connected pieces of the shape within each cell.
//!
//! What is connected are samples of the cell that lie inside, and triangles that overlap it. A stretch of a line inside
//! the surface connects the samples on it and the triangles at its ends; an edge connects the triangles beside it. A gap, however
//! narrow, ends a stretch, so what is on either side of it stays apart; a wall, however thin, is a stretch, so both its sides stay
//! together.

use glam::DVec3;

use super::grid::{Grid, SAMPLES};
use super::lines::{Inside, Lines};
use super::overlap::{segment_box, triangle_box};
use super::surface::Surface;
use super::union::Union;

/// Cells are larger by this share where triangles are looked for, so that rounding misses none.
const GENEROUS: f64 = 1e-7;

/// The pieces of all cells: sets of samples, then of triangles in cells.
pub(super) struct Pieces {
    /// Triangles in cells: (cell, face), sorted.
    pub triangles: Vec<(u32, u32)>,
    /// The least element of the piece of each element; samples come first, then `triangles`.
    pub piece: Vec<u32>,
    /// Whether a sample lies inside.
    pub inside: Vec<bool>,
}

/// What of a stretch lies in one cell.
pub(super) struct Part {
    /// The place of the cell.
    pub cell: [usize; 3],
    /// Where it begins and ends.
    pub ends: [f64; 2],
    /// Some element of its piece; none where rounding left nothing.
    pub element: Option<u32>,
}

/// The middle of a cell and its half sides, a little enlarged.
pub(super) fn cell_box(grid: &Grid, cell: usize) -> (DVec3, DVec3) {
    let half = DVec3::splat(0.5 * grid.spacing);
    (grid.corner(grid.place(cell)) + half, half * (1.0 + GENEROUS))
}

impl Pieces {
    /// Of a surface, by the lines through it.
    pub fn new(surface: &Surface, grid: &Grid, lines: &Lines) -> Self {
        let triangles = triangles_in_cells(surface, grid);
        let samples = grid.samples();
        let mut union = Union::new(samples + triangles.len());
        let mut pieces = Self { triangles, piece: Vec::new(), inside: vec![false; samples] };
        for (index, (cell, face)) in pieces.triangles.iter().enumerate() {
            let (centre, half) = cell_box(grid, *cell as usize);
            let corners = surface.corners(*face);
            for (edge, other) in &surface.neighbours[*face as usize] {
                let edge = *edge as usize;
                let ends = [corners[edge], corners[(edge + 1) % 3]];
                if segment_box(ends, centre, half)
                    && let Some(other) = pieces.triangle(grid, *cell as usize, *other)
                {
                    union.join((samples + index) as u32, other);
                }
            }
        }
        let mut inside = std::mem::take(&mut pieces.inside);
        lines.each(grid, |axis, across, stretch| {
            pieces.elements(grid, axis, across, stretch, |_, elements| {
                elements.windows(2).for_each(|pair| union.join(pair[0], pair[1]));
                for element in elements.iter().filter(|e| (**e as usize) < samples) {
                    inside[*element as usize] = true;
                }
            });
        });
        pieces.inside = inside;
        pieces.piece = (0..(samples + pieces.triangles.len()) as u32).map(|e| union.find(e)).collect();
        pieces
    }

    /// The element of a face in a cell.
    pub fn triangle(&self, grid: &Grid, cell: usize, face: u32) -> Option<u32> {
        let found = self.triangles.binary_search(&(cell as u32, face)).ok()?;
        Some((grid.samples() + found) as u32)
    }

    /// Tells the parts of a stretch, cell by cell.
    pub fn parts(&self, grid: &Grid, axis: usize, across: [usize; 2], stretch: Inside, mut tell: impl FnMut(Part)) {
        self.elements(grid, axis, across, stretch, |(cell, ends), elements| {
            tell(Part { cell, ends, element: elements.first().copied() });
        });
    }

    /// Tells the cells of a stretch, what of it they hold, and the elements there.
    fn elements(
        &self,
        grid: &Grid,
        axis: usize,
        across: [usize; 2],
        stretch: Inside,
        mut tell: impl FnMut(([usize; 3], [f64; 2]), &[u32]),
    ) {
        let [first, last] = stretch.ends.map(|x| grid.cell_along(axis, x));
        let mut at = [0; 3];
        at[(axis + 1) % 3] = across[0];
        at[(axis + 2) % 3] = across[1];
        let mut elements = Vec::with_capacity(SAMPLES + 2);
        for along in first..=last {
            let mut cell = at.map(|k| k / SAMPLES);
            cell[axis] = along;
            let number = grid.cell(cell);
            elements.clear();
            if along == first {
                elements.extend(self.triangle(grid, number, stretch.faces[0]));
            }
            for sample in along * SAMPLES..(along + 1) * SAMPLES {
                let x = grid.sample_along(axis, sample);
                if stretch.ends[0] <= x && x <= stretch.ends[1] {
                    at[axis] = sample;
                    elements.push(grid.sample(at) as u32);
                }
            }
            if along == last {
                elements.extend(self.triangle(grid, number, stretch.faces[1]));
            }
            let low = grid.low[axis] + grid.spacing * along as f64;
            let ends = [stretch.ends[0].max(low), stretch.ends[1].min(low + grid.spacing)];
            tell((cell, ends), &elements);
        }
    }
}

/// All triangles in cells, sorted.
fn triangles_in_cells(surface: &Surface, grid: &Grid) -> Vec<(u32, u32)> {
    let mut all = Vec::new();
    let reach = DVec3::splat(GENEROUS * grid.spacing);
    for face in 0..surface.faces.len() as u32 {
        let corners = surface.corners(face);
        let low = corners[0].min(corners[1]).min(corners[2]) - reach;
        let high = corners[0].max(corners[1]).max(corners[2]) + reach;
        let range = |axis: usize| grid.cell_along(axis, low[axis])..=grid.cell_along(axis, high[axis]);
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let cell = grid.cell([x, y, z]);
                    let (centre, half) = cell_box(grid, cell);
                    if triangle_box(corners, centre, half) {
                        all.push((cell as u32, face));
                    }
                }
            }
        }
    }
    all.sort_unstable();
    all
}
