//! Copies of cells: one for each connected piece of the solid within a cell.

use glam::DVec3;
use sscc::Progress;
use sscc::parts::DisjointSets;

use super::cells::{CELL_SAMPLES, Cells};
use super::crossings::{Interval, SAMPLES};
use super::grid::Grid;
use super::overlap::{Block, SLACK};
use super::pieces::{SampleSet, for_each_piece};
use super::probe::Probe;
use super::surface::Surface;
use crate::cancel::TestCounter;
use crate::interpolation::OCTANTS;

/// Minimum filled share of an octant. It gives every cube mass and stiffness, and bounds the ratio of the stiffness of
/// two octants by 1000, which costs three of sixteen digits. The added volume is a thousandth of the outermost layer,
/// less than the error of the sample lines.
pub(super) const MIN_FILL: f64 = 1e-3;

/// The copies of all cells, in the order of cells; within a cell in the order of their smallest elements.
pub(super) struct Copies {
    /// Copy of each element; undefined for samples outside.
    pub of_element: Vec<u32>,
    /// Cell of each copy.
    pub cell: Vec<u32>,
    /// Filled share of each octant.
    pub fill: Vec<[f64; 8]>,
}

impl Copies {
    /// Finds the connected pieces within cells. Points are in units of cells; `inside` has the intervals of each axis.
    ///
    /// # Errors
    /// When cancelled.
    pub fn new(
        grid: &Grid,
        cells: &Cells,
        surface: &Surface,
        points: &[DVec3],
        inside: &[Vec<Interval>; 3],
        progress: &dyn Progress,
    ) -> Result<Self, sscc::Error> {
        let mut sets = DisjointSets::new(cells.elements());
        let mut samples: Vec<SampleSet> = vec![0; cells.len()];
        let mut pierced = vec![false; cells.elements()];
        for axis in 0..3 {
            for_each_piece(grid, cells, axis, &inside[axis], |piece, _| {
                if cells.triangles(piece.cell).is_empty() {
                    return;
                }
                let first = cells.first_element(piece.cell);
                piece.elements().fold(None, |one, element| {
                    if element - first < CELL_SAMPLES {
                        samples[piece.cell] |= 1 << (element - first);
                    }
                    one.inspect(|one| sets.unite(*one, element)).or(Some(element))
                });
                piece.triangles().for_each(|element| pierced[element as usize] = true);
            });
        }
        let mut weights = vec![[1.0 / 3.0; 3]; cells.len()];
        let mut tests = TestCounter::new(progress);
        for cell in (0..cells.len()).filter(|c| !cells.triangles(*c).is_empty()) {
            tests.add(cells.triangles(cell).len())?;
            join_patches(grid, cells, surface, points, cell, &mut sets);
            let (low, block) = (grid.cell(cells.keys[cell]), block_of(grid, cells, cell));
            let corners_of = |t: &u32| surface.faces[*t as usize].map(|v| points[v as usize]);
            let corners: Vec<_> = cells.triangles(cell).iter().map(corners_of).collect();
            let parts: Vec<_> = corners.iter().map(|corners| block.clip(*corners)).collect();
            weights[cell] = axis_weights(&parts);
            let probe = Probe {
                cells,
                cell,
                low: DVec3::from_array(low.map(f64::from)),
                corners: &corners,
                parts: &parts,
                samples: samples[cell],
                pierced: &pierced,
            };
            probe.join(&mut sets, &mut tests)?;
        }
        drop(pierced);

        let mut copies = Self { of_element: vec![0; cells.elements()], cell: Vec::new(), fill: Vec::new() };
        for cell in 0..cells.len() {
            let first = cells.first_element(cell);
            for element in first..cells.first_element(cell + 1) {
                let number = element - first;
                let is_bordered = !cells.triangles(cell).is_empty();
                if is_bordered && number < CELL_SAMPLES && samples[cell] >> number & 1 == 0 {
                    continue;
                }
                let root = sets.find(element);
                copies.of_element[element as usize] = if root == element {
                    copies.cell.push(cell as u32);
                    copies.cell.len() as u32 - 1
                } else {
                    copies.of_element[root as usize]
                };
            }
        }
        copies.measure(grid, cells, inside, &weights);
        Ok(copies)
    }

    /// Measures the filled share of each octant by the lengths of its lines.
    fn measure(&mut self, grid: &Grid, cells: &Cells, inside: &[Vec<Interval>; 3], weights: &[[f64; 3]]) {
        let mut fill = vec![[0.0; 8]; self.cell.len()];
        // Total length of the lines through an octant, each half a cell long.
        let full = f64::from((SAMPLES / 2).pow(2)) * 0.5;
        for axis in 0..3 {
            for_each_piece(grid, cells, axis, &inside[axis], |piece, _| {
                let Some(element) = piece.elements().next() else { return };
                let of = &mut fill[self.of_element[element as usize] as usize];
                if cells.triangles(piece.cell).is_empty() {
                    *of = [1.0; 8];
                    return;
                }
                for (octant, half) in OCTANTS.iter().enumerate() {
                    let across = [1, 2].map(|k| half[(axis + k) % 3]);
                    if across == piece.line.map(|k| k / (SAMPLES / 2)) {
                        let low = 0.5 * f64::from(half[axis]);
                        let length = piece.ends[1].min(low + 0.5) - piece.ends[0].max(low);
                        of[octant] += weights[piece.cell][axis] * length.max(0.0) / full;
                    }
                }
            });
        }
        self.fill = fill.into_iter().map(|of| of.map(|share: f64| share.clamp(MIN_FILL, 1.0))).collect();
    }
}

/// Returns the box of a cell.
pub(super) fn block_of(grid: &Grid, cells: &Cells, cell: usize) -> Block {
    let low = grid.cell(cells.keys[cell]);
    Block::cells(low, low.map(|i| i + 1))
}

/// Joins triangles of a cell that share an edge within it.
fn join_patches(
    grid: &Grid,
    cells: &Cells,
    surface: &Surface,
    points: &[DVec3],
    cell: usize,
    sets: &mut DisjointSets,
) {
    // The slack is smaller than that of triangles, so both triangles at an edge in the box are in the cell's list.
    let block = block_of(grid, cells, cell).enlarged(0.5 * SLACK);
    for (number, triangle) in cells.triangles(cell).iter().enumerate() {
        let face = surface.faces[*triangle as usize];
        for (k, other) in surface.across[*triangle as usize].iter().enumerate() {
            let [from, to] = [face[k], face[(k + 1) % 3]].map(|v| points[v as usize]);
            if let Some(other) = cells.find_triangle(cell, *other)
                && block.meets_segment(from, to)
            {
                sets.unite(cells.triangle_element(cell, number), other);
            }
        }
    }
}

/// Returns the weight of the lines of each axis in a cell: the squares of the components of the mean normal. A line is
/// exact along its axis but samples across it, so lines that meet the surface steeply are more precise.
fn axis_weights(parts: &[(DVec3, DVec3)]) -> [f64; 3] {
    let mut sum = DVec3::ZERO;
    for (_, area) in parts {
        if *area != DVec3::ZERO {
            sum += *area * *area / area.length();
        }
    }
    let total = sum.element_sum();
    if total > 0.0 { (sum / total).to_array() } else { [1.0 / 3.0; 3] }
}
