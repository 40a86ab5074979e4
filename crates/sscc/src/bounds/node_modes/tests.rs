//! Residuals of the affine map of a node, against exact arithmetic.

use sscc_testing::cases;

use super::*;
use crate::bounds::tests::random::Random;
use crate::bounds::tests::rounding::exact;
use crate::{Metric, Modes, ReducedModel, TriMesh};

/// The node is a tilted thin plate with many vertices, and one vertex far away. The two faces of the plate move against each
/// other: the fitted gradient is hundreds of times larger than the modes over the size of the node, and residuals are differences
/// of large numbers.
#[test]
fn residuals_hold_what_the_fit_has_rounded() {
    let mut worst = 0.0_f64;
    for case in 0..cases(24) {
        let random = &mut Random::new(case);
        let count = 1000;
        let normal = random.vector().normalize();
        let (along, across) = normal.any_orthonormal_pair();
        let spread = 1.0 / f64::from(count).sqrt();
        let mut p = Vec::new();
        let mut modes = Vec::new();
        let last = random.below(count as usize - 1);
        for v in 0..count as usize {
            let side = if v % 2 == 0 { 1.0 } else { -1.0 };
            let [x, y] = [(); 2].map(|()| (2.0 * random.uniform() - 1.0) * spread);
            let out = if v + 1 == count as usize { along } else { DVec3::ZERO };
            p.push(along * x + across * y + normal * (side * 0.012 * spread) + out);
            // One vertex has the largest residual.
            let size = if v == last { 1.5 } else { 1.0 };
            modes.push(random.vector().abs().max(DVec3::splat(0.9)) * (side * size));
        }
        let faces = (0..count - 2).map(|i| [i, i + 1, i + 2]).collect();
        let (mesh, modes) = (TriMesh::new(p, faces).unwrap(), Modes::new(1, modes).unwrap());
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
        let scaled = ScaledModel::new(&model, model.metric(), &[0.0]);
        let vertices: Vec<u32> = (0..count).collect();
        let node = NodeModes::fit(&scaled, &vertices);
        let row_len = scaled.row_len;
        for axis in 0..3 {
            // The rounding bound of one of the two nodes.
            let rounding = scaled.rounding.per_norm(DVec3::AXES[axis]);
            let allowed = exact(node.residual[axis]) + exact(rounding);
            for &v in &vertices {
                let p = scaled.positions[v as usize];
                let fitted = (0..3).fold(exact(node.modes[axis * row_len]), |sum, j| {
                    let gradient = exact(node.gradient[(3 * j + axis) * row_len]);
                    sum + gradient * (exact(p[j]) - exact(node.center[j]))
                });
                let left = exact(scaled.modes(v)[axis * row_len]) - fitted;
                assert!(left <= allowed && -left <= allowed, "case {case}, vertex {v}, axis {axis}");
            }
            let gradient = (0..3).map(|j| node.gradient[(3 * j + axis) * row_len].abs()).fold(0.0, f64::max);
            worst = worst.max(gradient * node.half.length());
        }
    }
    assert!(worst > 300.0, "{worst}");
}
