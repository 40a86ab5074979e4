//! The corners of a polygon that may be in an ear, in a grid.

use glam::DVec2;
use sscc::parts::orient2d;

use super::work::{TooIntricate, Work};

/// Corners in cells. If a triangle of two edges and a diagonal contains a corner of a simple polygon, it contains one that
/// is not strictly convex. Corners at the position of another one, as where a polygon touches itself, are candidates, too.
pub(super) struct EarCandidates {
    low: DVec2,
    /// Cells along each axis, for one unit of length.
    scale: DVec2,
    /// Cells along each axis.
    count: usize,
    /// First entry of each cell in `corners`, and the number of all.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl EarCandidates {
    /// Collects the candidates of a polygon that turns left if `turn` is 1, right if it is -1.
    pub fn of(points: &[DVec2], turn: i8) -> Self {
        let count = points.len();
        let mut is_repeated = vec![false; count];
        let mut order: Vec<u32> = (0..count as u32).collect();
        let key = |corner: &u32| {
            let point = points[*corner as usize] + DVec2::ZERO;
            (point.x, point.y)
        };
        order.sort_unstable_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        for pair in order.windows(2).filter(|pair| key(&pair[0]) == key(&pair[1])) {
            pair.iter().for_each(|corner| is_repeated[*corner as usize] = true);
        }
        let is_candidate = |at: &u32| {
            let at = *at as usize;
            let (before, after) = (points[(at + count - 1) % count], points[(at + 1) % count]);
            is_repeated[at] || orient2d(before, points[at], after) != turn
        };
        let candidates: Vec<u32> = (0..count as u32).filter(is_candidate).collect();
        Self::in_cells(points, &candidates)
    }

    fn in_cells(points: &[DVec2], candidates: &[u32]) -> Self {
        let position = |corner: &u32| points[*corner as usize];
        let low = candidates.iter().map(position).reduce(DVec2::min).unwrap_or_default();
        let high = candidates.iter().map(position).reduce(DVec2::max).unwrap_or_default();
        let count = (candidates.len() as f64).sqrt().ceil().max(1.0);
        let scale = count / (high - low);
        let mut grid = Self { low, scale, count: count as usize, starts: Vec::new(), corners: Vec::new() };
        let mut cells: Vec<(u32, u32)> = candidates
            .iter()
            .map(|corner| {
                let [x, y] = grid.cell(position(corner));
                ((y * grid.count + x) as u32, *corner)
            })
            .collect();
        cells.sort_unstable();
        let before = |cell: usize| cells.partition_point(|(other, _)| (*other as usize) < cell) as u32;
        grid.starts = (0..=grid.count * grid.count).map(before).collect();
        grid.corners = cells.into_iter().map(|(_, corner)| corner).collect();
        grid
    }

    /// Returns the cell of a point. The cell is monotone in each coordinate, so the cells of a box's corners enclose those of
    /// its points.
    fn cell(&self, point: DVec2) -> [usize; 2] {
        // The conversion maps negative numbers, and the NaN of grids without extent, to 0.
        let cells = (point - self.low) * self.scale;
        [cells.x, cells.y].map(|cell| (cell as usize).min(self.count - 1))
    }

    /// Whether `accepts` holds for a candidate in the cells of the box. These may also contain candidates outside of
    /// the box.
    pub fn any_in_box(
        &self,
        low: DVec2,
        high: DVec2,
        work: &mut Work,
        mut accepts: impl FnMut(usize, &mut Work) -> Result<bool, TooIntricate>,
    ) -> Result<bool, TooIntricate> {
        let ([x_0, y_0], [x_1, y_1]) = (self.cell(low), self.cell(high));
        for y in y_0..=y_1 {
            // The cells of a row follow each other.
            let row = y * self.count;
            let corners = &self.corners[self.starts[row + x_0] as usize..self.starts[row + x_1 + 1] as usize];
            work.take(1 + corners.len())?;
            for corner in corners {
                if accepts(*corner as usize, work)? {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_candidate_in_a_box_is_visited() {
        // A comb whose notches are not convex.
        let points: Vec<DVec2> =
            (0..101).map(|i| DVec2::new(f64::from(i), if i % 2 == 0 { 1.0 } else { 5.0 })).collect();
        let points = [&points[..], &[DVec2::new(100.0, 0.0), DVec2::new(0.0, 0.0)]].concat();
        let grid = EarCandidates::of(&points, -1);
        for (low, high) in
            [((3.0, 0.5), (9.0, 1.0)), ((-9.0, -9.0), (200.0, 200.0)), ((4.0, 1.0), (4.0, 1.0))]
        {
            let (low, high) = (DVec2::from(low), DVec2::from(high));
            let mut found = Vec::new();
            let accepts = |at: usize, _: &mut Work| {
                found.push(at);
                Ok(false)
            };
            assert_eq!(grid.any_in_box(low, high, &mut Work::new(), accepts), Ok(false));
            found.sort_unstable();
            let is_inside = |at: &usize| {
                let p = points[*at];
                at.is_multiple_of(2) && (1..100).contains(at) && p.cmpge(low).all() && p.cmple(high).all()
            };
            let expected: Vec<usize> = (0..points.len()).filter(is_inside).collect();
            assert!(expected.iter().all(|at| found.contains(at)), "{found:?}");
            assert!(expected.len() > 2 || found.len() < 10, "{found:?}");
        }
        let none = EarCandidates::of(&points[..3], 1);
        assert_eq!(
            none.any_in_box(DVec2::ZERO, DVec2::ONE, &mut Work::of(0), |_, _| Ok(true)),
            Err(TooIntricate)
        );
        let same = EarCandidates::of(&[DVec2::ONE; 5], 1);
        assert_eq!(same.any_in_box(DVec2::ONE, DVec2::ONE, &mut Work::new(), |_, _| Ok(true)), Ok(true));
    }
}
