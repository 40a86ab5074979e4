//! Computes, for tests, the gaps that a search for ratios may have used.

use super::corner_gaps::CornerGaps;
use crate::hierarchy::Hierarchy;

/// Returns for each node its parent; for the root itself.
pub(super) fn parents(hierarchy: &Hierarchy) -> Vec<u32> {
    let nodes = hierarchy.nodes();
    let mut parents = vec![0; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        node.children().for_each(|child| parents[child as usize] = n as u32);
    }
    parents
}

/// Returns the widest gap that a search may have used for two vertices of two leaves: along the direction of a table, of the
/// centres of the leaves, or of the centres of two nodes around them.
pub(super) fn widest_gap(
    gaps: &CornerGaps<'_>,
    parents: &[u32],
    (n, m): (u32, u32),
    (i, j): (u32, u32),
) -> f64 {
    let ((n, m), (i, j)) = if n <= m { ((n, m), (i, j)) } else { ((m, n), (j, i)) };
    let at = |leaf: u32, v: u32| gaps.vertices(leaf).binary_search(&v).unwrap();
    let mut widest = match gaps.near((n, m)) {
        Some(Some(table)) => {
            let len = gaps.vertices(m).len();
            let one = f64::from(table.gaps[at(n, i) * len + at(m, j)]);
            let other = if n == m { f64::from(table.gaps[at(n, j) * len + at(m, i)]) } else { f64::INFINITY };
            one.min(other)
        }
        Some(None) => 0.0,
        None => {
            let mut components = [Vec::new(), Vec::new()];
            let is_apart = gaps.components((n, m), &mut components).is_some();
            let [a, b] = [components[0][at(n, i)], components[1][at(m, j)]];
            if is_apart { CornerGaps::gap_between(a, b) } else { 0.0 }
        }
    };
    let above = |mut n: u32| {
        let mut all = vec![n];
        while parents[n as usize] != n {
            n = parents[n as usize];
            all.push(n);
        }
        all
    };
    for x in above(n) {
        for y in above(m) {
            let [x, y] = [x, y].map(|n| gaps.spheres[n as usize]);
            widest = widest.max((y.center - x.center).length() - x.radius - y.radius);
        }
    }
    widest
}
