//! Tests bounds of pairs of corners whose relative motion cancels against exact arithmetic.

use super::*;
use crate::bounds::tests::random::Random;
use crate::bounds::tests::rounding::exact;
use crate::{Metric, Modes, ReducedModel, TriMesh};

/// One of the 64 pairs of corners nearly keeps its distance, because the motions of the centres and of the two boxes cancel
/// there: its Gram matrix is only rounding error.
#[test]
fn corners_that_cancel_keep_their_rate() {
    let p = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let mesh = TriMesh::new(p, vec![[0, 1, 2]]).unwrap();
    let mut small = 0;
    for case in 0..2000 {
        let random = &mut Random::new(case);
        let rank = 1 + random.below(12);
        let modes = Modes::new(rank, vec![DVec3::Z * 1e-9; 3 * rank]).unwrap();
        let model = ReducedModel::with_metric(mesh.clone(), modes, Metric::identity(rank)).unwrap();
        let scaled = ScaledModel::new(&model, model.metric(), &vec![0.0; rank]);
        let row_len = scaled.row_len;
        // All motion is along z: boxes of half extent 1, `gap` apart, move away from each other while they expand.
        let (gap, left) = (random.power(-9.0, -7.0), random.power(-10.0, -8.0));
        let rates: Vec<f64> = (0..rank).map(|_| 2.0 * random.uniform() - 1.0).collect();
        let node = |side: f64| {
            let (mut modes, mut gradient) = (vec![0.0; 3 * row_len], vec![0.0; 9 * row_len]);
            for (k, rate) in rates.iter().enumerate() {
                modes[2 * row_len + k] = side * rate * (1.0 - 0.5 * left);
                gradient[8 * row_len + k] = *rate;
            }
            let center = DVec3::Z * (side * (1.0 + 0.5 * gap));
            NodeModes { center, half: DVec3::new(0.0, 0.0, 1.0), residual: DVec3::ZERO, modes, gradient }
        };
        let (n, m) = (node(-1.0), node(1.0));
        let mut scratch = NodePairScratch::new(row_len);
        inverse_gram(&n, &m, &mut scratch);
        let bound = bound_corners_along(&n, &m, DVec3::Z, &scaled, &mut scratch);
        // The distance and the rate of the corners that face each other, computed exactly.
        let distance = exact(m.center.z) - exact(1.0) - (exact(n.center.z) + exact(1.0));
        let square: sscc_testing::Dyadic = (0..rank)
            .map(|k| {
                let at = |node: &NodeModes, side: f64| {
                    exact(node.modes[2 * row_len + k]) - exact(side) * exact(node.gradient[8 * row_len + k])
                };
                at(&m, 1.0) - at(&n, -1.0)
            })
            .map(|rate| &rate * &rate)
            .sum();
        assert!(exact(bound) * exact(bound) * square <= &distance * &distance, "case {case}: {bound:e}");
        small += usize::from(bound < 1.0);
    }
    assert!(small > 1000, "{small}");
}

/// Nodes that are apart have a direction: the same one in any unit of the modes. Nodes that touch have none.
#[test]
fn directions_do_not_depend_on_the_unit_of_modes() {
    for unit in [1e-20, 1.0, 1e20] {
        let node = |x: f64| NodeModes {
            center: DVec3::X * x,
            half: DVec3::splat(0.25),
            residual: DVec3::ZERO,
            modes: vec![x * unit; 12],
            gradient: vec![0.0; 36],
        };
        let bounds = NodePairBounds { nodes: vec![node(0.0), node(1.0), node(0.4)] };
        let mut scratch = NodePairScratch::new(4);
        // The Gram matrix has entries of 4, and 0.012 more on its diagonal.
        let along = -4.0 / 8.012;
        let dir = bounds.direction(0, 1, &mut scratch).unwrap();
        assert!((dir - DVec3::new(1.0, along, along)).length() < 1e-9, "{unit:e}: {dir}");
        assert_eq!(bounds.direction(0, 2, &mut scratch), None);
    }
}
