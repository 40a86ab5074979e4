//! Moving hulls for the pair tree: for each stored node pair a direction that separates its hulls at the centre.
//!
//! A query rotates this direction with the two nodes, and tests the plane across it. Node pairs whose hulls are not separate at
//! the centre are opened without a test of hulls: only the time of queries depends on that.

use super::hulls::{MovedHulls, NodeHulls};
use crate::ReducedModel;
use crate::certificates::PairTree;
use crate::detect::f32_frame::F32Frame;
use crate::detect::layout::Layout;
use crate::detect::vertex_motion::{DeformedMotion, VertexMotion};
use crate::hierarchy::{Hierarchy, NodePair};
use crate::parallel;
use glam::Vec3;

/// The hulls of nodes, and a direction for each node pair stored in the pair tree.
pub(super) struct PairHulls {
    pub(super) nodes: NodeHulls,
    /// The components of the directions in units of 1 / [`WHOLE`]; all 0 if a node pair has no separating direction.
    directions: Vec<[i16; 3]>,
}

/// The integer that stands for the component 1 of a direction.
const WHOLE: f32 = 32767.0;

impl PairHulls {
    /// Computes hulls and directions about the centre of the certificates; `None` if the pair tree is empty, or
    /// [`NodeHulls::new`] returns none.
    pub(super) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        layout: &Layout,
        tree: &PairTree,
        center: &[f64],
    ) -> Option<Self> {
        if tree.is_empty() {
            return None;
        }
        let reach = model.check_coordinates(center).ok()?;
        let pairs = node_pairs(hierarchy, tree);
        let nodes = NodeHulls::new(model, hierarchy, &pairs, center)?;
        let motion = DeformedMotion::new([center], reach);
        let mut moved = MovedHulls::<1>::new(&nodes);
        moved.update_all(&nodes, &F32Frame::around(motion.overall_aabb(layout)), &motion);
        let quantized = |dir: Vec3| (dir * WHOLE).to_array().map(|x| x.round() as i16);
        let direction = |pair: &NodePair| moved.separating_direction(&nodes, *pair).map_or([0; 3], quantized);
        let directions = parallel::map(&pairs, direction);
        Some(Self { nodes, directions })
    }

    /// Returns the direction of an entry, if it has one.
    #[inline]
    pub(super) fn direction(&self, entry: u32) -> Option<Vec3> {
        let dir = self.directions[entry as usize];
        (dir != [0; 3]).then(|| Vec3::from_array(dir.map(f32::from)))
    }
}

/// Returns the stored node pairs, in the order of their indices in the pair tree.
fn node_pairs(hierarchy: &Hierarchy, tree: &PairTree) -> Vec<NodePair> {
    let mut pairs = vec![(0, 0); tree.len()];
    let mut stack = Vec::new();
    for (n, node) in hierarchy.nodes().iter().enumerate() {
        let children: Vec<NodePair> = node.child_pairs().collect();
        for stored in tree.of_node(n as u32) {
            stack.push((stored.index, children[stored.entry.which() as usize]));
        }
    }
    while let Some((index, (n, m))) = stack.pop() {
        pairs[index as usize] = (n, m);
        if let Some(split) = hierarchy.split_above_buckets(n, m) {
            stack.extend(tree.below(index).map(|stored| (stored.index, split.pair(stored.entry.which()))));
        }
    }
    pairs
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use crate::test_models::Random;
    use crate::{
        Certificates, CertifyOptions, KineticQuery, Method, Metric, MetricKind, Modes, Query, ReducedModel,
        TriMesh,
    };

    /// Returns a coil of a flat band, whose windings swing against each other, bend and widen.
    fn coil(turns: u32, rank: usize) -> ReducedModel {
        let around = 24 * turns;
        let at = |i: u32, j: u32| {
            let t = f64::from(i) / 24.0;
            let (sin, cos) = (std::f64::consts::TAU * t).sin_cos();
            (t / f64::from(turns), DVec3::new(cos, sin, 0.25 * t + 0.1 * f64::from(j)))
        };
        let (mut positions, mut rows) = (Vec::new(), Vec::new());
        for (t, x) in (0..=around).flat_map(|i| (0..2).map(move |j| at(i, j))) {
            positions.push(x);
            rows.extend((0..rank).map(|k| {
                let wave = ((k / 3 + 1) as f64 * 3.0 * t + k as f64).sin();
                [DVec3::X, DVec3::Y, DVec3::Z][k % 3] * wave + x * if k == 3 { 0.2 } else { 0.0 }
            }));
        }
        let faces = (0..2 * around).map(|i| [i, i + 1, i + 2]).collect();
        ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(rank, rows).unwrap()).unwrap()
    }

    /// Pairs, impacts and kinetic answers are those without hulls, in states where hulls separate most node pairs, and in
    /// states far beyond them, about several centres and in a dense metric.
    #[test]
    fn hulls_change_no_answer() {
        let (mut free, mut colliding, mut tests) = (0, 0, 0);
        for case in 0..6 {
            let random = &mut Random(case + 60);
            let model = coil(8 + case as u32, 6);
            let center = (case % 2 == 1).then(|| (0..6).map(|_| 0.02 * random.signed()).collect());
            let metric = (case % 3 == 2).then(|| {
                // The matrix is close to the unit matrix, hence positive definite.
                let entry = |i: usize, j: usize| if i == j { 1.0 } else { 0.1 };
                Metric::from_matrix(
                    MetricKind::Given,
                    6,
                    &(0..36).map(|i| entry(i / 6, i % 6)).collect::<Vec<f64>>(),
                )
                .unwrap()
            });
            let options = CertifyOptions::default().center(center).metric(metric);
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            let scope = Arc::clone(&certificates.parts().scope);
            let mut query = Query::new(&model, &certificates).unwrap();
            let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
            let mut plain = Query::without_certificates(&model, scope, Method::BdTree).unwrap();
            let dir: Vec<f64> = (0..6).map(|_| random.signed()).collect();
            for i in 0..70 {
                let share = if i < 60 { 0.004 * f64::from(i) } else { 0.5 * f64::from(i - 58) };
                let size = share * certificates.parts().pair_tree.limit();
                let at = |s: f64| -> Vec<f64> { dir.iter().map(|x| x * s).collect() };
                let (t0, t1) = (at(size), at(size * 1.01));
                let pairs = plain.discrete(&t0).unwrap().to_vec();
                assert_eq!(query.discrete(&t0).unwrap(), pairs, "case {case}, {i}");
                tests += query.discrete.certified.broad.state.counters.hull_tests;
                assert_eq!(kinetic.discrete(&t0).unwrap(), pairs, "case {case}, {i}");
                (free, colliding) =
                    (free + i32::from(pairs.is_empty()), colliding + i32::from(!pairs.is_empty()));
                let impacts = plain.continuous(&t0, &t1).unwrap().to_vec();
                assert_eq!(query.continuous(&t0, &t1).unwrap(), impacts, "case {case}, {i}");
            }
        }
        let counts = [free, colliding];
        assert!(counts.iter().all(|count| *count > 30) && tests > 1000, "{counts:?} {tests}");
    }
}
