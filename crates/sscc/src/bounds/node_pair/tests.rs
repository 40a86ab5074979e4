//! What the affine map of a node leaves over, against exact arithmetic.

use super::super::reference::Random;
use super::super::rounding_tests::exact;
use super::*;
use crate::{Metric, Modes, ReducedModel, TriMesh};

/// A thin plate askew of many vertices and one far out, whose two faces move against each other: the gradient that is
/// fitted is hundreds of times larger than the modes over the size of the node, and what is left over is a difference
/// of large numbers.
#[test]
fn residuals_hold_what_the_fit_has_rounded() {
    let mut worst = 0.0_f64;
    for case in 0..24 {
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
            // Of one vertex alone most is left over.
            let size = if v == last { 1.5 } else { 1.0 };
            modes.push(random.vector().abs().max(DVec3::splat(0.9)) * (side * size));
        }
        let faces = (0..count - 2).map(|i| [i, i + 1, i + 2]).collect();
        let (mesh, modes) = (TriMesh::new(p, faces).unwrap(), Modes::new(1, modes).unwrap());
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
        let scaled = ScaledModel::new(&model, model.metric(), &[0.0]);
        let vertices: Vec<u32> = (0..count).collect();
        let cluster = Cluster::fit(&scaled, &vertices);
        let row = scaled.row;
        for axis in 0..3 {
            // Of the rate error, which is granted once for each of two nodes.
            let rounding = scaled.error.rate(DVec3::AXES[axis]);
            let allowed = exact(cluster.residual[axis]) + exact(rounding);
            for &v in &vertices {
                let p = scaled.positions[v as usize];
                let fitted = (0..3).fold(exact(cluster.modes[axis * row]), |sum, j| {
                    let gradient = exact(cluster.gradient[(3 * j + axis) * row]);
                    sum + gradient * (exact(p[j]) - exact(cluster.centre[j]))
                });
                let left = exact(scaled.modes(v)[axis * row]) - fitted;
                assert!(left <= allowed && -left <= allowed, "case {case}, vertex {v}, axis {axis}");
            }
            let gradient = (0..3).map(|j| cluster.gradient[(3 * j + axis) * row].abs()).fold(0.0, f64::max);
            worst = worst.max(gradient * cluster.half.length());
        }
    }
    assert!(worst > 300.0, "{worst}");
}

/// Of 64 pairs of corners one nearly keeps its distance, because what the centres and the two boxes do cancels there: in
/// the Gram matrix of it nothing but rounding is left.
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
        let row = scaled.row;
        // Along z alone: boxes of half extent 1, `gap` apart, which expand away from each other.
        let (gap, left) = (random.power(-9.0, -7.0), random.power(-10.0, -8.0));
        let rates: Vec<f64> = (0..rank).map(|_| 2.0 * random.uniform() - 1.0).collect();
        let cluster = |side: f64| {
            let (mut modes, mut gradient) = (vec![0.0; 3 * row], vec![0.0; 9 * row]);
            for (k, rate) in rates.iter().enumerate() {
                modes[2 * row + k] = side * rate * (1.0 - 0.5 * left);
                gradient[8 * row + k] = *rate;
            }
            let centre = DVec3::Z * (side * (1.0 + 0.5 * gap));
            Cluster { centre, half: DVec3::new(0.0, 0.0, 1.0), residual: DVec3::ZERO, modes, gradient }
        };
        let (x, y) = (cluster(-1.0), cluster(1.0));
        let mut scratch = ClusterScratch::new(row);
        inverse_gram(&x, &y, &mut scratch);
        let bound = corner_bound(&x, &y, DVec3::Z, &scaled, &mut scratch);
        // The corners that face each other, exactly.
        let distance = exact(y.centre.z) - exact(1.0) - (exact(x.centre.z) + exact(1.0));
        let square: num_rational::BigRational = (0..rank)
            .map(|k| {
                let at = |c: &Cluster, side: f64| {
                    exact(c.modes[2 * row + k]) - exact(side) * exact(c.gradient[8 * row + k])
                };
                at(&y, 1.0) - at(&x, -1.0)
            })
            .map(|rate| &rate * &rate)
            .sum();
        assert!(exact(bound) * exact(bound) * square <= &distance * &distance, "case {case}: {bound:e}");
        small += usize::from(bound < 1.0);
    }
    assert!(small > 1000, "{small}");
}
