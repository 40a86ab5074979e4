//! The smallest gap of each two vertices over all pairs of triangles of two leaves that contain them. Leaves that are far apart
//! have none: the gap of their spheres serves.

use std::collections::HashMap;

use glam::DVec3;
use rayon::prelude::*;

use super::local_certificates::UnitModel;
use super::strain_bound::widest_gaps;
use crate::filter::{PairFilter, Relation, SimplexPair};
use crate::hierarchy::{Hierarchy, NodePair};

/// Leaves have a table where the gap of their spheres is at most this share of the sum of the radii.
const NEAR: f64 = 2.5;

/// Gaps between the vertices of two leaves.
pub(super) struct GapTable {
    /// For each vertex of the first leaf those of the second, rounded down; infinite where no pair of triangles counts.
    pub(super) gaps: Vec<f32>,
    pub(super) smallest: f32,
}

/// The vertices of all leaves, and the tables of those that are near.
pub(super) struct GapTables {
    /// For each node its vertices if it is a leaf.
    pub(super) vertices: Vec<Vec<u32>>,
    /// None where two triangles that count have no gap.
    tables: HashMap<NodePair, Option<GapTable>>,
}

impl GapTables {
    pub(super) fn new(unit: &UnitModel, hierarchy: &Hierarchy, filter: &PairFilter) -> Self {
        let nodes = hierarchy.nodes();
        let vertices: Vec<Vec<u32>> = nodes
            .iter()
            .map(|node| if node.is_leaf() { hierarchy.vertices(node, filter.faces()) } else { Vec::new() })
            .collect();
        let mut spheres = vec![(DVec3::ZERO, 0.0_f64); nodes.len()];
        for n in (0..nodes.len()).rev() {
            let node = &nodes[n];
            let points: Vec<(DVec3, f64)> = if node.is_leaf() {
                vertices[n].iter().map(|v| (unit.positions[*v as usize], 0.0)).collect()
            } else {
                node.children().map(|child| spheres[child as usize]).collect()
            };
            let center = points.iter().map(|(center, _)| *center).sum::<DVec3>() / points.len() as f64;
            let radius = points.iter().map(|(c, r)| (*c - center).length() + r).fold(0.0, f64::max);
            spheres[n] = (center, radius);
        }
        let mut near: Vec<NodePair> = Vec::new();
        let mut stack = vec![(0, 0)];
        while let Some((n, m)) = stack.pop() {
            let [a, b] = [n, m].map(|n| nodes[n as usize]);
            if n != m {
                let ((c, r), (d, s)) = (spheres[n as usize], spheres[m as usize]);
                if (d - c).length() > (1.0 + NEAR) * (r + s) {
                    continue;
                }
            }
            match (a.is_leaf(), b.is_leaf()) {
                (true, true) => near.push((n.min(m), n.max(m))),
                _ if n == m => {
                    stack.extend(a.children().map(|c| (c, c)));
                    stack.extend(a.child_pairs());
                }
                (false, _) if b.is_leaf() || a.triangle_count >= b.triangle_count => {
                    stack.extend(a.children().map(|c| (c, m)));
                }
                _ => stack.extend(b.children().map(|c| (n, c))),
            }
        }
        let table = |&(n, m): &NodePair| {
            let [x, y] = [n, m].map(|n| &vertices[n as usize]);
            let mut gaps = vec![f32::INFINITY; x.len() * y.len()];
            let mut smallest = f32::INFINITY;
            let [list_a, list_b] = [n, m].map(|n| hierarchy.triangles(&nodes[n as usize]));
            for (index, &s) in list_a.iter().enumerate() {
                for &t in if n == m { &list_b[index + 1..] } else { list_b } {
                    if filter.relation(s, t) == Relation::Adjacent || filter.is_excluded(s, t) {
                        continue;
                    }
                    for SimplexPair { a, b } in filter.simplex_pairs(s, t) {
                        let [p, q] = [a, b].map(|corners| corners.map(|v| unit.positions[v as usize]));
                        let differences: [DVec3; 9] = std::array::from_fn(|ij| q[ij % 3] - p[ij / 3]);
                        let Some(found) = widest_gaps(&differences) else { return ((n, m), None) };
                        for (ij, gap) in found.into_iter().enumerate() {
                            // A simplex pair of one leaf may have its corners in either order.
                            let [i, j] = [(x, a[ij / 3]), (y, b[ij % 3])]
                                .map(|(list, v)| list.binary_search(&v).unwrap_or(0));
                            let gap = ((gap * (1.0 - 1e-6)) as f32).next_down();
                            let entry = &mut gaps[i * y.len() + j];
                            *entry = entry.min(gap);
                            smallest = smallest.min(gap);
                        }
                    }
                }
            }
            ((n, m), (smallest > 0.0).then_some(GapTable { gaps, smallest }))
        };
        let tables = near.par_iter().map(table).collect();
        Self { vertices, tables }
    }

    /// The table of two leaves, if they are near.
    pub(super) fn get(&self, n: u32, m: u32) -> Option<&Option<GapTable>> {
        self.tables.get(&(n.min(m), n.max(m)))
    }
}
