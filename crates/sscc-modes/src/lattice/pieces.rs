//! Inside intervals of sample lines, split at cell boundaries.

use super::cells::{CELL_SAMPLES, Cells, NONE};
use super::crossings::{Interval, SAMPLES, sample_at};
use super::grid::{Grid, cell_along};

/// The part of an interval within one cell.
pub(super) struct Piece<'a> {
    /// Axis of the line.
    pub axis: usize,
    /// Index of the cell.
    pub cell: usize,
    /// Coordinates of its ends along the axis, within the cell: from 0 to 1.
    pub ends: [f64; 2],
    /// Number of the line within the cell.
    pub line: [u32; 2],
    /// Triangles at its ends, if the ends are in this cell.
    triangles: [Option<u32>; 2],
    cells: &'a Cells,
}

impl Piece<'_> {
    /// Returns the elements of its cell that the piece passes.
    pub fn elements(&self) -> impl Iterator<Item = u32> {
        let first = self.cells.first_element(self.cell);
        let mut step = [1, SAMPLES, SAMPLES * SAMPLES];
        step.rotate_left(self.axis);
        let across = self.line[0] * step[1] + self.line[1] * step[2];
        let is_bordered = !self.cells.triangles(self.cell).is_empty();
        let of_line = if is_bordered { SAMPLES } else { 1 };
        let samples = (0..of_line).filter_map(move |k| {
            let inside = self.ends[0] <= sample_at(k) && sample_at(k) <= self.ends[1];
            if is_bordered { inside.then_some(first + across + k * step[0]) } else { Some(first) }
        });
        samples.chain(self.triangles())
    }

    /// Returns the elements of the triangles at its ends in this cell.
    pub fn triangles(&self) -> impl Iterator<Item = u32> {
        self.triangles.iter().flatten().filter_map(|t| self.cells.find_triangle(self.cell, *t))
    }
}

/// Calls `call` with each piece of the intervals of an axis, and with the piece before it in the same interval. Between
/// cells that lie wholly inside, only one line is reported.
pub(super) fn for_each_piece(
    grid: &Grid,
    cells: &Cells,
    axis: usize,
    intervals: &[Interval],
    mut call: impl FnMut(&Piece, Option<&Piece>),
) {
    for Interval { line, enter, leave } in intervals {
        let [from, to] = [enter, leave].map(|end| cell_along(end.0, grid.size[axis]));
        let mut place = [0; 3];
        place[(axis + 1) % 3] = line[0] / SAMPLES;
        place[(axis + 2) % 3] = line[1] / SAMPLES;
        let mut last: Option<Piece> = None;
        for along in from..=to {
            place[axis] = along;
            let cell = match &last {
                Some(piece) => Some(cells.next[piece.cell][axis]).filter(|c| *c != NONE).map(|c| c as usize),
                None => cells.find(grid.key(place)),
            };
            // By rounding, an end at a border may lie in a cell that the solid does not touch.
            let Some(cell) = cell else {
                last = None;
                continue;
            };
            let piece = Piece {
                axis,
                cell,
                ends: [enter.0, leave.0].map(|at| (at - f64::from(along)).clamp(0.0, 1.0)),
                line: line.map(|k| k % SAMPLES),
                triangles: [(along == from).then_some(enter.1), (along == to).then_some(leave.1)],
                cells,
            };
            let is_whole = |of: &Piece| cells.triangles(of.cell).is_empty();
            if piece.line == [0, 0] || !is_whole(&piece) || !last.as_ref().is_none_or(is_whole) {
                call(&piece, last.as_ref());
            }
            last = Some(piece);
        }
    }
}

/// Set of samples of a cell, as bits.
pub(super) type SampleSet = u64;
const _: () = assert!(CELL_SAMPLES == SampleSet::BITS);
