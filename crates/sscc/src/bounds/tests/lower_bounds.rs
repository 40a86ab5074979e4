//! Tests every bound against the true minimum, as far as a slow search finds it.

#![allow(clippy::print_stdout)] // statistics for those who tune the bounds

use glam::DVec3;
use sscc_testing::cases;

use super::models::{KINDS, ROOM, all_bounds, node_pair_bound, pair_corners, random_pair, reference};
use super::random::Random;
use crate::bounds::cone_rate::bound_rate_in_cone;
use crate::bounds::separating_direction::bound_rest_distance;
use crate::bounds::strain::StrainGram;
use crate::geometry::nearest_to_origin;
use crate::model::{ScaledModel, scale_direction};
use crate::{Metric, MetricKind, Modes, ReducedModel, TriMesh};

#[test]
fn no_bound_exceeds_the_true_minimum() {
    let mut checked = [0; KINDS];
    let mut ratios = Vec::new();
    for case in 0..cases(2600_u64) {
        let random = &mut Random::new(case);
        let kind = case as usize % KINDS;
        let model = random_pair(kind, random);
        let pair = reference(&model, [0, 1]);
        let Some(truth) = pair.true_minimum(4, random) else { continue };
        checked[kind] += 1;
        for (name, bound) in all_bounds(&model, random) {
            assert!(bound <= truth * ROOM, "case {case}, kind {kind}: {name} {bound:e} above {truth:e}");
            if name == "refine" && truth > 0.0 && pair.rank() >= 3 {
                ratios.push((bound / truth, kind));
            }
        }
        let safe = [pair.eq10_safe(), pair.line_estimate_safe(), pair.box_estimate_safe()];
        // The rounding of the reference is not bounded: kinds of pairs in which numbers cancel are left out.
        if ![2, 3, 4, 5, 6, 10, 12].contains(&kind) {
            for (i, bound) in safe.into_iter().enumerate() {
                assert!(
                    bound <= truth * (1.0 + 1e-6),
                    "case {case}: reference {i} {bound:e} above {truth:e}"
                );
            }
        }
    }
    println!("cases with a known minimum, by kind: {checked:?}");
    for kind in 0..KINDS {
        let mut of_kind: Vec<f64> = ratios.iter().filter(|r| r.1 == kind).map(|r| r.0).collect();
        of_kind.sort_by(f64::total_cmp);
        if let (Some(least), Some(median)) = (of_kind.first(), of_kind.get(of_kind.len() / 2)) {
            println!("kind {kind}: {} ratios, least {least:.3}, median {median:.3}", of_kind.len());
        }
    }
    let mut plain: Vec<f64> = ratios.iter().filter(|r| r.1 < 2).map(|r| r.0).collect();
    plain.sort_by(f64::total_cmp);
    assert!(plain[plain.len() / 2] >= 0.8, "median tightness {}", plain[plain.len() / 2]);
}

/// Powers of two times positions and modes change nothing but the exponent of the true minimum: bounds hold
/// near the ends of the range of numbers, where squares overflow or vanish.
#[test]
fn bounds_hold_for_extreme_sizes() {
    for case in 0..cases(900_u64) {
        let random = &mut Random::new(case + 50_000);
        let model = random_pair(case as usize % (KINDS - 1), random);
        let Some(truth) = reference(&model, [0, 1]).true_minimum(3, random) else { continue };
        let (size, speed) = (150 - random.below(1000) as i32, 150 - random.below(300) as i32);
        let (mesh, modes) = (model.mesh(), model.modes());
        let grow = |x: &[DVec3], power: i32| x.iter().map(|x| *x * 2.0_f64.powi(power)).collect::<Vec<_>>();
        let mesh = TriMesh::new(grow(mesh.rest_positions(), size), mesh.faces().to_vec()).unwrap();
        let modes = Modes::new(modes.rank(), grow(modes.displacements(), speed)).unwrap();
        let large = ReducedModel::with_metric(mesh, modes, model.metric().clone()).unwrap();
        let truth =
            truth * 2.0_f64.powi((size - speed) / 2) * 2.0_f64.powi((size - speed) - (size - speed) / 2);
        for (name, bound) in all_bounds(&large, random) {
            assert!(
                bound <= truth * ROOM,
                "case {case}, 2^{size} 2^{speed}: {name} {bound:e} above {truth:e}"
            );
        }
        let bound = node_pair_bound(&large, 1);
        assert!(
            bound <= truth * ROOM,
            "case {case}, 2^{size} 2^{speed}: node pair {bound:e} above {truth:e}"
        );
    }
}

#[test]
fn rest_distance_is_never_too_large() {
    for case in 0..600_u64 {
        let random = &mut Random::new(case + 10_000);
        let model = random_pair(case as usize % KINDS, random);
        let scaled = ScaledModel::new(&model, model.metric(), &vec![0.0; model.rank()]);
        let differences = pair_corners(&scaled).differences();
        let distance = reference(&model, [0, 1]).rest_distance(4, random);
        for dir in [nearest_to_origin(&differences).point, random.vector(), differences.iter().sum()] {
            let Some(dir) = scale_direction(dir) else { continue };
            let bound = bound_rest_distance(&differences, dir, &scaled.rounding);
            assert!(bound <= distance * ROOM, "case {case}: {bound:e} above {distance:e}");
        }
    }
}

/// Compares the rate on a cone with the rate at sampled directions of it.
#[test]
fn cone_rate_is_never_too_small() {
    for case in 0..3000_u64 {
        let random = &mut Random::new(case + 20_000);
        let rank = 1 + random.below(8);
        // Symmetric gradients, some nearly singular, and their Mandel components.
        let flat = if case % 3 == 0 { random.power(-9.0, 0.0) } else { 1.0 };
        let strains: Vec<[f64; 6]> = (0..rank)
            .map(|_| std::array::from_fn(|i| (random.uniform() - 0.5) * if i == 2 { flat } else { 1.0 }))
            .collect();
        let gram: StrainGram =
            std::array::from_fn(|i| std::array::from_fn(|j| strains.iter().map(|s| s[i] * s[j]).sum()));
        let axis = random.vector();
        let width = random.power(-17.0, 0.0);
        let d: [DVec3; 9] = match case % 4 {
            0 => [axis; 9],
            1 => std::array::from_fn(|_| axis * random.power(-3.0, 3.0)),
            _ => std::array::from_fn(|_| (axis + random.vector() * width) * random.power(-1.0, 1.0)),
        };
        let rate_at = |u: DVec3| {
            let root = std::f64::consts::SQRT_2;
            let m = [u.x * u.x, u.y * u.y, u.z * u.z, u.y * u.z * root, u.x * u.z * root, u.x * u.y * root];
            let forms = strains.iter().map(|s| s.iter().zip(m).map(|(s, m)| s * m).sum::<f64>());
            forms.map(|f| f * f).sum::<f64>().sqrt()
        };
        for wanted in [0.0, 0.1, f64::INFINITY] {
            let rate = bound_rate_in_cone(&d, &gram, rank.next_multiple_of(4), wanted, 1e-12);
            for sample in 0..60 {
                let u: DVec3 = if sample < 9 {
                    d[sample]
                } else {
                    d.iter().map(|d| *d * random.uniform().powi(4)).sum()
                };
                let here = rate_at(u.normalize());
                assert!(here <= rate * ROOM, "case {case}: {here:e} above {rate:e}");
            }
        }
    }
}

#[test]
fn node_pair_bounds_hold_for_all_their_pairs() {
    let mut positive = 0;
    for case in 0..700_u64 {
        let random = &mut Random::new(case + 30_000);
        let rank = if case % 5 == 0 { 1 + random.below(30) } else { 1 + random.below(8) };
        let (count, split) = (2 + random.below(5), 1);
        let split = split + random.below(count - 1);
        let size = random.power(-2.0, 0.0);
        let gap = random.power(-2.0, 1.0);
        let p: Vec<DVec3> = (0..3 * count)
            .map(|v| {
                random.vector() * size
                    + if v < 3 * split { DVec3::ZERO } else { DVec3::X * (gap + 2.0 * size) }
            })
            .collect();
        let offset = if case % 4 == 0 { random.vector() * random.power(0.0, 10.0) } else { DVec3::ZERO };
        let (linear, quadratic) = (random.power(-3.0, 0.0), random.power(-6.0, 0.0));
        let common = if case % 3 == 0 { random.power(0.0, 8.0) } else { 0.0 };
        let flat = if case % 7 == 0 { random.power(-12.0, -1.0) } else { 1.0 };
        let mut columns: Vec<Vec<DVec3>> = Vec::new();
        for _ in 0..rank {
            let (g, t, c) =
                ([(); 3].map(|()| random.vector()), [random.vector(), random.vector()], random.vector());
            columns.push(
                (0..3 * count)
                    .map(|v| {
                        let x = p[v];
                        let moved = t[usize::from(v < 3 * split)]
                            + (g[0] * x.x + g[1] * x.y + g[2] * x.z) * linear
                            + random.vector() * quadratic;
                        moved * DVec3::new(flat, 1.0, 1.0) + c * common
                    })
                    .collect(),
            );
        }
        let displacements = (0..3 * count).flat_map(|v| columns.iter().map(move |c| c[v])).collect();
        let faces = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriMesh::new(p.iter().map(|p| *p + offset).collect(), faces).unwrap();
        let modes = Modes::new(rank, displacements).unwrap();
        let model = if case % 2 == 0 {
            ReducedModel::new(mesh, modes).unwrap()
        } else {
            let scales = (0..rank).map(|_| random.power(-6.0, 6.0)).collect();
            let metric = Metric::from_scales(MetricKind::Given, scales).unwrap();
            ReducedModel::with_metric(mesh, modes, metric).unwrap()
        };
        let bound = node_pair_bound(&model, split as u32);
        positive += u32::from(bound > 0.0);
        for x in 0..split as u32 {
            for y in split as u32..count as u32 {
                if let Some(truth) = reference(&model, [x, y]).true_minimum(3, random) {
                    assert!(bound <= truth * ROOM, "case {case}, {x} {y}: {bound:e} above {truth:e}");
                }
            }
        }
    }
    assert!(positive > 400, "{positive}");
}

/// Along n = (1, -1, 0) the relative modes nearly cancel: computed from their Gram matrix, the closing rate is exactly 0, which
/// would give an infinite radius. The bound must include the mode of 1e-9 that remains.
#[test]
fn cancelling_modes_keep_node_pair_bounds_finite() {
    let (a, b) = (DVec3::new(1.0, 1.0, 0.0), DVec3::new(1e-9, 0.0, 0.0));
    let n = DVec3::new(1.0, -1.0, 0.0);
    let form = |m: [f64; 3]| n.x * n.x * m[0] + 2.0 * n.x * n.y * m[1] + n.y * n.y * m[2];
    assert_eq!(form([a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y]), 0.0);

    let corners = [DVec3::ZERO, DVec3::Z * 0.25, DVec3::new(0.125, 0.125, 0.125)];
    let p = [corners, corners.map(|p| p + n)].concat();
    let displacements = (0..6).flat_map(|v| [a, b].map(|u| if v < 3 { DVec3::ZERO } else { u })).collect();
    let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::new(2, displacements).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(2)).unwrap();
    // Y = X + n returns to X where z_0 + 1e-9 z_1 = -1 and z_0 = 1.
    let truth = 2e9_f64.hypot(1.0);
    let bound = node_pair_bound(&model, 1);
    assert!(bound > 0.0 && bound <= truth, "{bound:e}");
    for (name, bound) in all_bounds(&model, &mut Random::new(1)) {
        assert!(bound <= truth * ROOM, "{name} {bound:e}");
    }
}
