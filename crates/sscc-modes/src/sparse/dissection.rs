//! Geometric nested dissection: elimination order with little fill.

use glam::DVec3;

use super::BlockSparse;

/// Maximum number of vertices of a set that is not split; the order within a dense block does not matter.
const MAX_LEAF_VERTICES: usize = 64;

/// Minimum share of the vertices on either side of a cut. Within this limit, a plane of a lattice goes to one side as a
/// whole, so that the separator is flat.
const MIN_SHARE: f64 = 0.25;

/// Returns the vertices in order of elimination: halves first, then their separator (George 1973). The cut is across the
/// longest axis, next to the median. The separator consists of the vertices of one side that touch the other, on the side
/// with fewer of them.
pub(crate) fn nested_dissection(matrix: &BlockSparse, positions: &[DVec3]) -> Vec<usize> {
    let mut order = Vec::with_capacity(positions.len());
    // Set of each vertex: twice the number of the cut, plus the side.
    let mut side = vec![0_usize; positions.len()];
    let mut cuts = 0;
    // Stack of sets to order. Separators are below their halves and are not split again.
    let mut stack = vec![((0..positions.len()).collect::<Vec<usize>>(), true)];
    while let Some((mut set, divisible)) = stack.pop() {
        if !divisible || set.len() <= MAX_LEAF_VERTICES {
            order.extend(set);
            continue;
        }
        let at = sort_and_cut(&mut set, positions);
        cuts += 1;
        let (low, high) = (2 * cuts, 2 * cuts + 1);
        set[..at].iter().for_each(|v| side[*v] = low);
        set[at..].iter().for_each(|v| side[*v] = high);
        let upper = set.split_off(at);
        let touching = |part: &[usize], other: usize| {
            let touches = |v: &usize| matrix.columns(*v).iter().any(|w| side[*w as usize] == other);
            part.iter().copied().partition::<Vec<usize>, _>(touches)
        };
        let ((low_border, low_rest), (high_border, high_rest)) =
            (touching(&set, high), touching(&upper, low));
        let (separator, first, second) = if low_border.len() <= high_border.len() {
            (low_border, low_rest, upper)
        } else {
            (high_border, set, high_rest)
        };
        stack.extend([(separator, false), (second, true), (first, true)]);
    }
    order
}

/// Sorts vertices along their longest axis; returns the index of the cut.
fn sort_and_cut(set: &mut [usize], positions: &[DVec3]) -> usize {
    let low = set.iter().fold(DVec3::INFINITY, |m, v| m.min(positions[*v]));
    let high = set.iter().fold(DVec3::NEG_INFINITY, |m, v| m.max(positions[*v]));
    let extent = high - low;
    let axis = (0..3).fold(0, |best, k| if extent[k] > extent[best] { k } else { best });
    set.sort_unstable_by(|a, b| positions[*a][axis].total_cmp(&positions[*b][axis]).then(a.cmp(b)));
    let middle = positions[set[set.len() / 2]][axis];
    // Coordinates in one plane may differ by rounding.
    let slack = 1e-9 * extent[axis];
    let before = set.partition_point(|v| positions[*v][axis] < middle - slack);
    let after = set.partition_point(|v| positions[*v][axis] <= middle + slack);
    let balance = |at: usize| at.min(set.len() - at);
    let best = if balance(before) >= balance(after) { before } else { after };
    if balance(best) as f64 >= MIN_SHARE * set.len() as f64 { best } else { set.len() / 2 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::Lattice;
    use crate::sparse::Analysis;

    #[test]
    fn the_order_is_a_permutation_also_where_positions_coincide() {
        let body = Lattice::free(9, 7, 5);
        for positions in [body.positions.clone(), vec![DVec3::ONE; body.positions.len()]] {
            let mut order = nested_dissection(&body.stiffness, &positions);
            assert_eq!(order, nested_dissection(&body.stiffness, &positions));
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(i, v)| i == *v));
        }
    }

    #[test]
    fn there_is_less_fill_than_in_the_natural_order() {
        let body = Lattice::free(14, 14, 14);
        let natural: Vec<usize> = (0..body.positions.len()).collect();
        let without = Analysis::with_order(&body.stiffness, &natural).unwrap().entries();
        let with = Analysis::new(&body.stiffness, &body.positions).unwrap().entries();
        assert!(10 * with < 7 * without, "{with} {without}");
    }
}
