//! Cells that the solid touches, with their triangles.

use glam::DVec3;
use sscc::Progress;

use super::crossings::{Interval, SAMPLES};
use super::grid::{Grid, cell_along};
use super::overlap::{Block, SLACK};
use crate::cancel::check_cancelled;

/// Placeholder for no cell.
pub(super) const NONE: u32 = u32::MAX;

/// Number of samples in a cell.
pub(super) const CELL_SAMPLES: u32 = SAMPLES * SAMPLES * SAMPLES;

/// The cells that the solid touches, x-fastest, and their *elements*: the samples and the triangles of a cell that has
/// triangles; a single one for a cell that lies wholly inside.
pub(super) struct Cells {
    /// Numbers in the grid, ascending.
    pub keys: Vec<u64>,
    /// For each cell its neighbours one step further along each axis, or [`NONE`].
    pub next: Vec<[u32; 3]>,
    /// Triangles of cell i: `triangles[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    triangles: Vec<u32>,
    /// The first element of each cell, then the number of all.
    element: Vec<u32>,
}

impl Cells {
    /// Finds the cells of a surface (points in units of cells), given the inside intervals of the lines along x.
    ///
    /// # Errors
    /// When cancelled.
    pub fn new(
        grid: &Grid,
        points: &[DVec3],
        faces: &[[u32; 3]],
        along_x: &[Interval],
        progress: &dyn Progress,
    ) -> Result<Self, sscc::Error> {
        let mut incidences: Vec<(u64, u32)> = Vec::with_capacity(2 * faces.len());
        for (number, face) in (0_u32..).zip(faces) {
            if number.is_multiple_of(4096) {
                check_cancelled(progress)?;
            }
            let corners = face.map(|v| points[v as usize]);
            let low = grid.cell_of(corners[0].min(corners[1]).min(corners[2]) - SLACK);
            let high = grid.cell_of(corners[0].max(corners[1]).max(corners[2]) + SLACK);
            visit(low, high.map(|i| i + 1), corners, &mut |cell| incidences.push((grid.key(cell), number)));
        }
        incidences.sort_unstable();

        let mut keys: Vec<u64> = incidences.chunk_by(|a, b| a.0 == b.0).map(|of| of[0].0).collect();
        let bordered = keys.len();
        // One line through each row of cells finds the cells that lie wholly inside.
        for interval in along_x.iter().filter(|i| i.line.map(|k| k % SAMPLES) == [0, 0]) {
            let [y, z] = interval.line.map(|k| k / SAMPLES);
            let (from, to) = (interval.enter.0, interval.leave.0);
            let row = cell_along(from, grid.size[0])..=cell_along(to, grid.size[0]);
            let inside = row.map(|x| grid.key([x, y, z]));
            keys.extend(
                inside.filter(|key| keys[..bordered].binary_search(key).is_err()).collect::<Vec<_>>(),
            );
        }
        keys.sort_unstable();
        keys.dedup();

        let (mut first, mut element) = (vec![0], vec![0]);
        let (mut seen, mut elements) = (0, 0);
        for key in &keys {
            let count = incidences[seen..].iter().take_while(|i| i.0 == *key).count();
            seen += count;
            elements += if count == 0 { 1 } else { CELL_SAMPLES + count as u32 };
            first.push(seen as u32);
            element.push(elements);
        }
        let next = neighbours(grid, &keys);
        Ok(Self { keys, next, first, triangles: incidences.into_iter().map(|i| i.1).collect(), element })
    }

    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Returns the number of elements of all cells.
    pub fn elements(&self) -> usize {
        self.first_element(self.len()) as usize
    }

    /// Returns the first element of a cell: its first sample, if it has triangles.
    pub fn first_element(&self, cell: usize) -> u32 {
        self.element[cell]
    }

    /// Returns the element of a triangle, given by its index within the cell.
    pub fn triangle_element(&self, cell: usize, number: usize) -> u32 {
        self.element[cell] + CELL_SAMPLES + number as u32
    }

    /// Returns the element of a triangle in a cell, if the triangle meets the cell.
    pub fn find_triangle(&self, cell: usize, triangle: u32) -> Option<u32> {
        let number = self.triangles(cell).binary_search(&triangle).ok()?;
        Some(self.triangle_element(cell, number))
    }

    /// Returns the triangles in a cell, ascending; none in a cell that lies wholly inside.
    pub fn triangles(&self, cell: usize) -> &[u32] {
        &self.triangles[self.first[cell] as usize..self.first[cell + 1] as usize]
    }

    /// Returns the index of a cell in this list.
    pub fn find(&self, key: u64) -> Option<usize> {
        self.keys.binary_search(&key).ok()
    }
}

/// Calls `found` for each cell of a block that the triangle meets, by halving the block.
fn visit(low: [u32; 3], high: [u32; 3], corners: [DVec3; 3], found: &mut impl FnMut([u32; 3])) {
    if !Block::cells(low, high).enlarged(SLACK).meets_triangle(corners) {
        return;
    }
    let size: [u32; 3] = std::array::from_fn(|k| high[k] - low[k]);
    let axis = if size[0] >= size[1].max(size[2]) {
        0
    } else if size[1] >= size[2] {
        1
    } else {
        2
    };
    if size[axis] == 1 {
        return found(low);
    }
    let (mut middle_high, mut middle_low) = (high, low);
    middle_high[axis] = low[axis] + size[axis] / 2;
    middle_low[axis] = middle_high[axis];
    visit(low, middle_high, corners, found);
    visit(middle_low, high, corners, found);
}

/// Returns the next cell along each axis for each cell.
fn neighbours(grid: &Grid, keys: &[u64]) -> Vec<[u32; 3]> {
    let steps = [0, 1, 2].map(|axis| {
        let mut unit = [0; 3];
        unit[axis] = 1;
        grid.key(unit)
    });
    let mut ahead = [0; 3];
    let neighbour = |key: &u64| {
        let cell = grid.cell(*key);
        std::array::from_fn(|axis| {
            let wanted = key + steps[axis];
            // Keys ascend, so each search continues where the last one ended.
            ahead[axis] += keys[ahead[axis]..].iter().take_while(|k| **k < wanted).count();
            let exists = cell[axis] + 1 < grid.size[axis] && keys.get(ahead[axis]) == Some(&wanted);
            if exists { ahead[axis] as u32 } else { NONE }
        })
    };
    keys.iter().map(neighbour).collect()
}
