//! The box and the affine map of a node against plain formulas, its residuals also against exact arithmetic.

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

/// The box holds all vertices and is hardly larger. The gradient solves the equations of the regularised fit, the modes
/// at the centre are those of the fit, and the residuals are what both leave of the modes of the vertices.
#[test]
fn maps_are_least_squares_and_residuals_are_what_they_leave() {
    for case in 0..60 {
        let random = &mut Random::new(case);
        let (count, rank) = (15 + random.below(30), 1 + random.below(12));
        let far = random.vector() * 3.0;
        let p: Vec<DVec3> = (0..count).map(|_| far + random.vector() * DVec3::new(1.0, 0.5, 0.7)).collect();
        let modes = Modes::new(rank, (0..count * rank).map(|_| random.vector()).collect()).unwrap();
        let faces = (0..count as u32 - 2).map(|i| [i, i + 1, i + 2]).collect();
        let mesh = TriMesh::new(p, faces).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
        let scaled = ScaledModel::new(&model, model.metric(), &vec![0.0; rank]);
        // The other vertices are of other nodes.
        let vertices: Vec<u32> = (0..count as u32).filter(|v| v % 3 != 1).collect();
        let node = NodeModes::fit(&scaled, &vertices);
        let (row_len, number) = (scaled.row_len, vertices.len() as f64);
        let at = |v: &u32| scaled.positions[*v as usize];
        let mean = vertices.iter().map(at).sum::<DVec3>() / number;
        let mut moment = [[0.0; 3]; 3];
        for d in vertices.iter().map(|v| at(v) - mean) {
            for (i, j) in (0..9).map(|ij| (ij / 3, ij % 3)) {
                moment[i][j] += d[i] * d[j];
            }
        }
        let ridge = 1e-4 * (moment[0][0] + moment[1][1] + moment[2][2]);
        (0..3).for_each(|i| moment[i][i] += ridge);
        for row in 0..3 * row_len {
            let gradient = |j: usize| node.gradient[3 * j * row_len + row];
            for i in 0..3 {
                let wanted: f64 = vertices.iter().map(|v| scaled.modes(*v)[row] * (at(v) - mean)[i]).sum();
                let found: f64 = (0..3).map(|j| gradient(j) * moment[j][i]).sum();
                assert!((found - wanted).abs() < 1e-8, "case {case}, {row} {i}: {found}, not {wanted}");
            }
            let average = vertices.iter().map(|v| scaled.modes(*v)[row]).sum::<f64>() / number;
            let wanted = average + (0..3).map(|j| gradient(j) * (node.center - mean)[j]).sum::<f64>();
            assert!((node.modes[row] - wanted).abs() < 1e-9, "case {case}, {row}");
        }
        for axis in 0..3 {
            let left = |v: &u32| {
                let offset = at(v) - node.center;
                let row = |k: usize| axis * row_len + k;
                let gradient = |k: usize, j: usize| node.gradient[3 * j * row_len + row(k)];
                let fitted =
                    |k: usize| node.modes[row(k)] + (0..3).map(|j| gradient(k, j) * offset[j]).sum::<f64>();
                let squares = (0..row_len).map(|k| (scaled.modes(*v)[row(k)] - fitted(k)).powi(2));
                squares.sum::<f64>().sqrt()
            };
            let largest = vertices.iter().map(left).fold(0.0, f64::max);
            let residual = node.residual[axis];
            assert!((residual - largest).abs() < 1e-10, "case {case}: {residual}, not {largest}");
            let (center, half) = (node.center[axis], node.half[axis]);
            for v in &vertices {
                let offset = exact(at(v)[axis]) - exact(center);
                assert!(offset.abs() <= exact(half), "case {case}, vertex {v}");
            }
            let farthest = vertices.iter().map(|v| (at(v)[axis] - center).abs()).fold(0.0, f64::max);
            assert!(half <= farthest * (1.0 + 1e-14), "case {case}: {half}");
        }
    }
}

/// The gap of two boxes is the vector between their nearest points.
#[test]
fn gaps_are_between_the_nearest_points_of_boxes() {
    let mut touching = 0;
    for case in 0..400 {
        let random = &mut Random::new(case);
        let mut node = || NodeModes {
            center: random.vector() * 2.0,
            half: random.vector().abs(),
            residual: DVec3::ZERO,
            modes: Vec::new(),
            gradient: Vec::new(),
        };
        let (n, m) = (node(), node());
        let gap = n.gap(&m);
        for axis in 0..3 {
            let [a, b] = [&n, &m].map(|n| [-1.0_f64, 1.0].map(|side| n.center[axis] + side * n.half[axis]));
            let wanted = (b[0] - a[1]).max(0.0) - (a[0] - b[1]).max(0.0);
            assert!((gap[axis] - wanted).abs() < 1e-12, "case {case}: {gap}");
        }
        touching += usize::from(gap == DVec3::ZERO);
    }
    assert!(touching > 4 && touching < 200, "{touching}");
}
