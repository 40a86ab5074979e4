//! Whether a polygon touches or crosses itself.

use glam::DVec2;
use sscc::parts::orient2d;

use super::work::{STEPS_OF_EXACT_SIGNS, TooIntricate, Work};

/// Whether no two edges of a polygon have a common point, apart from the corner of neighbours. Repeated corners, one after
/// the other, count as one. The test is exact.
///
/// The edges are swept along the axis along which they are shorter, relative to the polygon.
pub(super) fn is_simple(polygon: &[DVec2], work: &mut Work) -> Result<bool, TooIntricate> {
    let mut corners: Vec<DVec2> = polygon.to_vec();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    let count = corners.len();
    if count < 3 {
        return Ok(true);
    }
    let corner = |at: usize| corners[at % count];
    if (0..count).any(|at| folds_back(corner(at), corner(at + 1), corner(at + 2))) {
        return Ok(false);
    }
    let axis = shorter_axis(&corners);
    let mut edges: Vec<Edge> = (0..count).map(|at| Edge::new(corner(at), corner(at + 1), axis, at)).collect();
    work.take(count)?;
    edges.sort_unstable_by(|a, b| a.low.total_cmp(&b.low).then(a.number.cmp(&b.number)));
    for (at, edge) in edges.iter().enumerate() {
        for other in &edges[at + 1..] {
            work.take(1)?;
            if other.low > edge.high {
                break;
            }
            let between = edge.number.abs_diff(other.number);
            let are_neighbours = between == 1 || between == count - 1;
            let overlap = edge.side[0] <= other.side[1] && other.side[0] <= edge.side[1];
            if overlap && !are_neighbours {
                work.take(STEPS_OF_EXACT_SIGNS)?;
                let ends = |number: usize| [corner(number), corner(number + 1)];
                if intersect_segment_segment(ends(edge.number), ends(other.number)) {
                    return Ok(false);
                }
            }
        }
    }
    Ok(true)
}

/// An edge as its intervals.
struct Edge {
    /// Interval along the axis of the sweep.
    low: f64,
    high: f64,
    /// Interval along the other axis.
    side: [f64; 2],
    number: usize,
}

impl Edge {
    fn new(a: DVec2, b: DVec2, axis: usize, number: usize) -> Self {
        let (low, high) = (a.min(b), a.max(b));
        let other = 1 - axis;
        // No negative zero, which `total_cmp` places before zero.
        Self { low: low[axis] + 0.0, high: high[axis], side: [low[other], high[other]], number }
    }
}

/// Returns the axis along which the edges are shorter, relative to the polygon. Only the work depends on it.
fn shorter_axis(corners: &[DVec2]) -> usize {
    let (mut low, mut high, mut lengths) = (corners[0], corners[0], DVec2::ZERO);
    for pair in corners.windows(2) {
        lengths += (pair[1] - pair[0]).abs();
        (low, high) = (low.min(pair[1]), high.max(pair[1]));
    }
    let share = lengths / (high - low);
    usize::from(share.y < share.x)
}

/// Whether the edge from b to c lies along the one from a to b; both have positive length.
fn folds_back(a: DVec2, b: DVec2, c: DVec2) -> bool {
    // For collinear points: whether a and c are on the same side of b, in x, or in y on a vertical line.
    let same_side = |k: usize| (a[k] < b[k] && c[k] < b[k]) || (a[k] > b[k] && c[k] > b[k]);
    orient2d(a, b, c) == 0 && (same_side(0) || (a.x == b.x && same_side(1)))
}

/// Whether two closed segments have a common point: their boxes meet, and neither is strictly on one side of the other.
fn intersect_segment_segment([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let sides = [orient2d(a, b, c) * orient2d(a, b, d), orient2d(c, d, a) * orient2d(c, d, b)];
    let boxes_meet = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    boxes_meet && sides.iter().all(|side| *side <= 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(points: &[(f64, f64)]) -> bool {
        let points: Vec<DVec2> = points.iter().map(|(x, y)| DVec2::new(*x, *y)).collect();
        let turned: Vec<DVec2> = points.iter().map(|p| DVec2::new(p.y, -p.x)).collect();
        let found = is_simple(&points, &mut Work::new()).unwrap();
        assert_eq!(is_simple(&turned, &mut Work::new()).unwrap(), found);
        found
    }

    #[test]
    fn contacts_are_found() {
        assert!(check(&[(0., 0.), (4., 0.), (4., 4.), (2., 1.), (0., 4.)]));
        assert!(check(&[(0., 0.), (2., 0.), (2., 0.), (4., 0.), (4., 4.), (0., 4.), (0., 0.)]));
        // Crossing; a corner on an edge; a corner on another; a fold; a keyhole.
        assert!(!check(&[(0., 0.), (4., 4.), (4., 0.), (0., 4.)]));
        assert!(!check(&[(0., 0.), (4., 0.), (4., 4.), (2., 0.), (0., 4.)]));
        assert!(!check(&[(0., 0.), (4., 0.), (2., 2.), (4., 4.), (0., 4.), (2., 2.)]));
        assert!(!check(&[(0., 0.), (4., 0.), (2., 0.), (2., 3.)]));
        assert!(!check(&[(0., 0.), (0., 4.), (0., 2.), (3., 2.)]));
        assert!(check(&[(1., 1.); 4]) && check(&[]));
    }

    #[test]
    fn the_work_is_bounded() {
        let comb: Vec<DVec2> = (0..2000).map(|i| DVec2::new(f64::from(i), f64::from(i % 2 * 5000))).collect();
        let comb = [&comb[..], &[DVec2::new(2000.0, -1.0), DVec2::new(-1.0, -1.0)]].concat();
        let mut work = Work::new();
        let before = work.left();
        assert_eq!(is_simple(&comb, &mut work), Ok(true));
        assert!(before - work.left() < 20_000, "{}", before - work.left());
        assert_eq!(is_simple(&comb, &mut Work::of(100)), Err(TooIntricate));
    }
}
