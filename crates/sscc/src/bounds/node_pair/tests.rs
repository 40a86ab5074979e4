//! Tests bounds of pairs of corners whose relative motion cancels against exact arithmetic, and bounds of random
//! nodes against a plain formula.

use super::*;
use crate::bounds::tests::random::Random;
use crate::bounds::tests::rounding::exact;
use crate::model::mode_rows::padded_rank;
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

/// Returns a model of so large numbers that its rounding bounds are some hundredths, and so are the terms of its
/// clearance if it has one.
fn model_of_large_numbers(rank: usize, clearance: f64, random: &mut Random) -> ScaledModel {
    let size = 2e12;
    let p = (0..3).map(|_| random.vector() * size).collect();
    let modes = (0..3 * rank).map(|_| random.vector() * size).collect();
    let (mesh, modes) = (TriMesh::new(p, vec![[0, 1, 2]]).unwrap(), Modes::new(rank, modes).unwrap());
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
    let scaled = ScaledModel::new(&model, model.metric(), &vec![0.0; rank]);
    if clearance > 0.0 { scaled.keeping(clearance, 1e-14) } else { scaled }
}

/// Returns a node with this centre, whose other numbers are random.
fn random_node(center: DVec3, rank: usize, random: &mut Random) -> NodeModes {
    let row_len = padded_rank(rank);
    let half = DVec3::splat(0.05) + random.vector().abs() * 0.3;
    let residual = DVec3::splat(0.05) + random.vector().abs() * 0.2;
    let mut rows = |count: usize| -> Vec<f64> {
        let entries = 0..count * row_len;
        entries.map(|at| if at % row_len < rank { random.uniform() - 0.5 } else { 0.0 }).collect()
    };
    NodeModes { center, half, residual, modes: rows(3), gradient: rows(9) }
}

/// Returns the positions and the modes of the corners of a node's box.
fn corners_of(node: &NodeModes) -> Vec<(DVec3, Vec<f64>)> {
    let entries = node.modes.len();
    let corner = |number: usize| {
        let side = |axis: usize| if number & (1 << axis) == 0 { 1.0 } else { -1.0 };
        let offset = DVec3::new(side(0), side(1), side(2)) * node.half;
        let moved = |at: usize| (0..3).map(|j| node.gradient[j * entries + at] * offset[j]).sum::<f64>();
        (node.center + offset, (0..entries).map(|at| node.modes[at] + moved(at)).collect())
    };
    (0..8).map(corner).collect()
}

/// Returns the bound along a direction from all pairs of corners, one by one.
fn plain_bound(n: &NodeModes, m: &NodeModes, dir: DVec3, model: &ScaledModel) -> f64 {
    let required = model.required.along(dir);
    let at_rest = 2.0 * model.rounding.at_rest(dir) + required.at_rest;
    let slower = dir.abs().dot(n.residual) + dir.abs().dot(m.residual);
    let slack = slower + 2.0 * model.rounding.per_norm(dir) + required.per_norm;
    let mut bound = f64::INFINITY;
    for (x, modes_x) in corners_of(n) {
        for (y, modes_y) in corners_of(m) {
            let along = |k: usize, axis: usize| {
                let at = axis * model.row_len + k;
                dir[axis] * (modes_y[at] - modes_x[at])
            };
            let projected = (0..model.row_len).map(|k| along(k, 0) + along(k, 1) + along(k, 2));
            let rate = projected.map(|rate| rate * rate).sum::<f64>().sqrt() + slack;
            bound = bound.min((dir.dot(y - x) - at_rest).max(0.0) / rate);
        }
    }
    bound
}

/// Whether a bound is that of the plain formula, smaller by its terms for rounding: about a trillionth of it.
fn is_close(bound: f64, plain: f64) -> bool {
    bound <= plain * (1.0 + 1e-14) + 5e-14 && bound >= plain * (1.0 - 1e-9) - 1e-12
}

/// The bound along a direction is the smallest quotient of all 64 pairs of corners.
#[test]
fn bounds_along_directions_are_those_of_all_pairs_of_corners() {
    let mut positive = 0;
    for case in 0..400 {
        let random = &mut Random::new(case);
        let rank = 2 + random.below(11);
        let model = model_of_large_numbers(rank, if case % 2 == 0 { 0.0 } else { 0.05 }, random);
        let dir = scale_direction(random.vector()).unwrap();
        let center = random.vector();
        let other = center + dir * random.power(-0.3, 0.6) + random.vector() * 0.3;
        let (n, m) = (random_node(center, rank, random), random_node(other, rank, random));
        let mut scratch = NodePairScratch::new(model.row_len);
        inverse_gram(&n, &m, &mut scratch);
        let bound = bound_corners_along(&n, &m, dir, &model, &mut scratch);
        let plain = plain_bound(&n, &m, dir, &model);
        assert!(is_close(bound, plain), "case {case}: {bound:e}, not {plain:e}");
        positive += usize::from(plain > 0.01);
    }
    assert!(positive > 200, "{positive}");
}

/// Returns the directions between the centres and across the gap, in the metric of the relative modes and in space,
/// as far as they separate the boxes.
fn plain_directions(n: &NodeModes, m: &NodeModes) -> Vec<DVec3> {
    let (between, half) = (m.center - n.center, n.half + m.half);
    let across = |axis: usize| (between[axis].abs() - half[axis]).max(0.0).copysign(between[axis]);
    let gap = DVec3::new(across(0), across(1), across(2));
    let row_len = n.modes.len() / 3;
    let mut metric = DMat3::ZERO;
    for k in 0..row_len {
        let relative = |axis: usize| m.modes[axis * row_len + k] - n.modes[axis * row_len + k];
        let d = DVec3::new(relative(0), relative(1), relative(2));
        metric += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let trace = metric.x_axis.x + metric.y_axis.y + metric.z_axis.z;
    let inverse = (metric + DMat3::from_diagonal(DVec3::splat(1e-3 * trace))).inverse();
    let tried = [inverse * between, inverse * gap, between, gap].map(|dir| dir / dir.abs().max_element());
    tried.into_iter().filter(|dir| dir.dot(between) > dir.abs().dot(half)).collect()
}

/// The bound of two nodes is that of the first direction if it suffices or is far from sufficient, else that of the
/// first one that suffices, or the largest. A witness is a direction with a sufficient bound. Boxes that touch have
/// neither.
#[test]
fn bounds_are_those_of_the_first_direction_that_suffices() {
    let (mut apart, mut better) = (0, 0);
    for case in 0..400 {
        let random = &mut Random::new(case);
        let rank = 2 + random.below(11);
        let model = model_of_large_numbers(rank, 0.0, random);
        let centers = [random.vector(), random.vector()];
        let nodes: Vec<NodeModes> = centers.iter().map(|center| random_node(*center, rank, random)).collect();
        let bounds = NodePairBounds { nodes };
        let [n, m] = [0, 1].map(|at| bounds.of_node(at));
        assert_eq!(bounds.size(0), n.half.length_squared());
        let mut scratch = NodePairScratch::new(model.row_len);
        let wanted = plain_directions(n, m);
        let directions: Vec<DVec3> = candidates(n, m, &mut scratch).collect();
        assert_eq!(directions.len(), wanted.len(), "case {case}");
        for (dir, wanted) in directions.iter().zip(wanted) {
            assert!((*dir - wanted).length() < 1e-6, "case {case}: {dir}, not {wanted}");
        }
        assert_eq!(bounds.are_touching((0, 1)), directions.is_empty(), "case {case}");
        let mut bound = |sufficient: f64| bounds.bound(&model, 0, 1, sufficient, &mut scratch);
        let largest = if directions.is_empty() {
            assert_eq!(bound(f64::INFINITY), 0.0, "case {case}");
            0.0
        } else {
            let plain: Vec<f64> = directions.iter().map(|dir| plain_bound(n, m, *dir, &model)).collect();
            let (first, largest) = (plain[0], plain.iter().copied().fold(0.0, f64::max));
            let sufficing = plain.iter().copied().find(|plain| *plain >= 1.1 * first).unwrap_or(largest);
            for (sufficient, wanted) in
                [(f64::INFINITY, first), (0.5 * first, first), (2.0 * first, first), (1.1 * first, sufficing)]
            {
                let found = bound(sufficient);
                assert!(is_close(found, wanted), "case {case}, {sufficient:e}: {found:e}, not {wanted:e}");
            }
            let alone = bound(f64::INFINITY);
            assert_eq!(bound(alone), alone, "case {case}: it suffices");
            apart += 1;
            better += usize::from(largest > 1.001 * first && first > 0.01);
            let along = |dir: &DVec3| bound_corners_along(n, m, *dir, &model, &mut scratch);
            directions.iter().map(along).fold(0.0, f64::max)
        };
        match bounds.witness(&model, (0, 1), largest, &mut scratch) {
            Some(dir) => {
                assert!(bound_corners_along(n, m, dir, &model, &mut scratch) >= largest, "case {case}");
            }
            None => assert!(directions.is_empty(), "case {case}"),
        }
        assert_eq!(bounds.witness(&model, (0, 1), largest.next_up(), &mut scratch), None, "case {case}");
    }
    assert!(apart > 200 && apart < 390 && better > 100, "{apart} {better}");
}

/// Nodes that do not move have an infinite bound if their gap is larger than its rounding bound, and 0 if it is equal
/// to it. Numbers that are not finite prove nothing.
#[test]
fn bounds_without_a_gap_or_of_nan_are_0() {
    let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    let modes = Modes::new(1, vec![DVec3::ZERO; 3]).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
    let model = ScaledModel::new(&model, model.metric(), &[0.0]);
    let node = |x: f64| NodeModes {
        center: DVec3::X * x,
        half: DVec3::ZERO,
        residual: DVec3::ZERO,
        modes: vec![0.0; 12],
        gradient: vec![0.0; 36],
    };
    let bound = |n: &NodeModes, m: &NodeModes| {
        let mut scratch = NodePairScratch::new(4);
        inverse_gram(n, m, &mut scratch);
        bound_corners_along(n, m, DVec3::ONE, &model, &mut scratch)
    };
    let least = 2.0 * model.rounding.at_rest(DVec3::ONE);
    for (gap, wanted) in [(10.0, f64::INFINITY), (2.0 * least, f64::INFINITY), (least, 0.0), (-10.0, 0.0)] {
        assert_eq!(bound(&node(0.0), &node(gap)), wanted, "{gap:e}");
    }
    let places: [fn(&mut NodeModes, f64); 5] = [
        |node, x| node.center.x = x,
        |node, x| node.half.y = x,
        |node, x| node.residual.z = x,
        |node, x| node.modes[5] = x,
        |node, x| node.gradient[17] = x,
    ];
    for (at, set) in places.into_iter().enumerate() {
        for x in [f64::NAN, f64::INFINITY] {
            let [mut n, mut m] = [node(0.0), node(10.0)];
            set(&mut n, x);
            assert_eq!(bound(&n, &node(10.0)), 0.0, "number {at} of the first node: {x}");
            set(&mut m, x);
            assert_eq!(bound(&node(0.0), &m), 0.0, "number {at} of the second node: {x}");
        }
    }
}
