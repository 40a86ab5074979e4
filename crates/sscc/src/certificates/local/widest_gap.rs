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

#[cfg(test)]
mod tests {
    use sscc_testing::{FlexibleShape, Shape};

    use super::*;
    use crate::filter::PairFilter;
    use crate::{ContactFilter, Modes, ReducedModel, TriMesh};

    /// Nodes around leaves are found by their triangles, and only some vertices of each leaf are compared.
    #[test]
    fn widest_gaps_are_those_of_tables_components_or_spheres() {
        let (mut of_tables, mut of_components) = (0, 0);
        for seed in 0..2 {
            let FlexibleShape { positions, faces, .. } = FlexibleShape::new(seed, Shape::Ring, 1);
            let modes = Modes::from_matrix(positions.len(), 1, |_, _| 1e-3).unwrap();
            let model = ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap();
            let hierarchy = Hierarchy::build(&model, model.metric());
            let filter = PairFilter::new(&model, &ContactFilter::default());
            let positions = model.mesh().rest_positions();
            let gaps = CornerGaps::new(&hierarchy, &filter, positions, &()).unwrap().unwrap();
            let (nodes, parents) = (hierarchy.nodes(), parents(&hierarchy));
            let leaves: Vec<u32> = (0..nodes.len() as u32).filter(|n| nodes[*n as usize].is_leaf()).collect();
            let own = |n: u32| {
                let node = &nodes[n as usize];
                node.first_triangle..node.first_triangle + node.triangle_count
            };
            let around = |n: u32| -> Vec<_> {
                let holds = |x: &u32| own(*x).start <= own(n).start && own(n).end <= own(*x).end;
                (0..nodes.len() as u32).filter(holds).map(|x| gaps.spheres[x as usize]).collect()
            };
            let mut components = [Vec::new(), Vec::new()];
            let pairs = leaves.iter().enumerate();
            for (n, m) in pairs.flat_map(|(at, n)| leaves[at..].iter().map(move |m| (*n, *m))) {
                let [around_n, around_m] = [n, m].map(&around);
                let of_spheres = around_n
                    .iter()
                    .flat_map(|x| {
                        around_m.iter().map(move |y| y.center.distance(x.center) - x.radius - y.radius)
                    })
                    .fold(f64::NEG_INFINITY, f64::max);
                let [x, y] = [n, m].map(|n| gaps.vertices(n));
                let is_apart =
                    gaps.near((n, m)).is_none() && gaps.components((n, m), &mut components).is_some();
                for (a, i) in x.iter().enumerate().step_by(8) {
                    for (b, j) in y.iter().enumerate().step_by(7) {
                        let one: f64 = match gaps.near((n, m)) {
                            Some(Some(table)) if n == m => {
                                table.gaps[a * y.len() + b].min(table.gaps[b * y.len() + a]).into()
                            }
                            Some(Some(table)) => table.gaps[a * y.len() + b].into(),
                            None if is_apart => CornerGaps::gap_between(components[0][a], components[1][b]),
                            Some(None) | None => 0.0,
                        };
                        let found = widest_gap(&gaps, &parents, (n, m), (*i, *j));
                        assert_eq!(found, of_spheres.max(one), "{n} {m}: {i} {j}");
                        assert_eq!(widest_gap(&gaps, &parents, (m, n), (*j, *i)), found, "{n} {m}: {i} {j}");
                        let distance = positions[*i as usize].distance(positions[*j as usize]);
                        assert!(found == f64::INFINITY || found <= distance + 1e-12, "{n} {m}: {i} {j}");
                        of_tables += usize::from(found.is_finite() && gaps.near((n, m)).is_some());
                        of_components += usize::from(is_apart);
                    }
                }
            }
        }
        assert!(of_tables > 100 && of_components > 1000, "{of_tables} {of_components}");
    }
}
