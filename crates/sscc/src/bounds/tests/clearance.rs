//! Tests bounds with a clearance where the smallest `|z|` is known, and against a z at which points are nearer.

use glam::DVec3;
use sscc_testing::cases;

use super::models::{
    KINDS, ROOM, all_bounds_keeping, node_pair_bound_keeping, random_pair, reference, scaled_keeping,
};
use super::random::Random;
use super::true_minimum::{gram, length};
use crate::{Metric, MetricKind, Modes, ReducedModel, TriMesh, distance_triangle_triangle};

/// Returns two triangles with these corners, and the displacements of each corner by each mode.
fn model(p: [DVec3; 6], modes: Vec<[DVec3; 6]>) -> ReducedModel {
    let displacements = (0..6).flat_map(|v| modes.iter().map(move |u| u[v])).collect();
    let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let metric = Metric::from_scales(MetricKind::Given, vec![1.0; modes.len()]).unwrap();
    ReducedModel::with_metric(mesh, Modes::new(modes.len(), displacements).unwrap(), metric).unwrap()
}

/// Three modes move one triangle along the axes: the triangles are as near as D where `|z|` is their distance less D. Other modes
/// move both triangles alike. Some models are far from the origin, some tiny or huge.
#[test]
fn bounds_of_translations_are_the_distance_less_the_clearance() {
    let mut tight = 0;
    for case in 0..cases(800_u64) {
        let random = &mut Random::new(case);
        let size = [1.0, 1e-40, 1e40, 1e-3][case as usize % 4];
        let far = if case % 3 == 0 { random.vector() * random.power(0.0, 3.0) } else { DVec3::ZERO };
        let mut p: [DVec3; 6] = std::array::from_fn(|_| random.vector());
        p[3..].iter_mut().for_each(|p| *p += DVec3::ONE * random.power(-0.5, 0.5));
        let p = p.map(|p| (p + far) * size);
        let relative = DVec3::AXES.map(|axis| [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, axis, axis, axis]);
        let common = (0..random.below(40)).map(|_| [random.vector(); 6]);
        let model = model(p, relative.into_iter().chain(common).collect());
        let distance = distance_triangle_triangle(&[p[0], p[1], p[2]], &[p[3], p[4], p[5]]);
        let clearance = distance * [0.5, 0.999, random.power(-9.0, 0.0)][case as usize % 3];
        if distance == 0.0 {
            continue;
        }
        let truth = distance - clearance;
        let room = truth * 1e-12;
        for (name, bound) in all_bounds_keeping(&model, clearance, random) {
            assert!(bound <= truth + room, "case {case}: {name} {bound:e} above {truth:e}");
            tight += u32::from(name == "refine" && bound >= truth * 0.89);
        }
        let bound = node_pair_bound_keeping(&model, clearance, 1);
        assert!(bound <= truth + room, "case {case}: node pair {bound:e} above {truth:e}");
        // Bounds are 0, up to rounding, if the clearance is at least the distance.
        for factor in [1.0, 1.0 + 1e-9, 3.0] {
            let bounds = all_bounds_keeping(&model, distance * factor, random);
            assert!(bounds.iter().all(|(_, bound)| *bound <= distance * 1e-11), "case {case}: {bounds:?}");
        }
    }
    assert!(tight > cases(800) as u32 / 2, "{tight}");
}

/// One mode presses two parallel plates together: all gaps shrink alike, and an affine map describes the whole motion.
#[test]
fn bounds_of_a_contraction_are_those_of_its_distances() {
    for case in 0..cases(400_u64) {
        let random = &mut Random::new(case + 1000);
        let (thickness, share) = (random.power(-1.0, 0.5), random.uniform());
        let plate: [DVec3; 3] = std::array::from_fn(|_| random.vector() * DVec3::new(0.0, 1.0, 1.0));
        let p: [DVec3; 6] =
            std::array::from_fn(|v| plate[v % 3] + DVec3::X * if v > 2 { thickness } else { 0.0 });
        let model = model(p, vec![p.map(|p| DVec3::new(-p.x, 0.0, 0.0))]);
        // Both plates meet at |z| = 1.
        let truth = 1.0 - share;
        let bounds = all_bounds_keeping(&model, share * thickness, random);
        for (name, bound) in &bounds {
            assert!(*bound <= truth * (1.0 + 1e-9) + 1e-12, "case {case}: {name} {bound:e} above {truth:e}");
        }
        let of =
            |wanted: &str| bounds.iter().filter(|(name, _)| *name == wanted).fold(0.0_f64, |b, x| b.max(x.1));
        assert!(of("affine") >= truth * 0.95 - 1e-6, "case {case}: {} of {truth}", of("affine"));
        assert!(node_pair_bound_keeping(&model, share * thickness, 1) <= truth * (1.0 + 1e-9));
    }
}

/// Directions are scaled, not normalised: along a diagonal a gap is longer than the distance.
#[test]
fn clearances_are_measured_along_unit_directions() {
    let along = DVec3::ONE.normalize();
    let (x, y) = (along.any_orthonormal_vector(), along.cross(along.any_orthonormal_vector()));
    let p = [DVec3::ZERO, x, y, along, along + x, along + y];
    let down = [DVec3::ZERO, DVec3::ZERO, DVec3::ZERO, -along, -along, -along];
    let model = model(p, vec![down]);
    let bounds = all_bounds_keeping(&model, 0.25, &mut Random::new(1));
    let best = bounds.iter().map(|bound| bound.1).fold(0.0, f64::max);
    assert!((best - 0.75).abs() < 1e-9 && best <= 0.75, "{best}");
}

/// No bound is larger than the `|z|` at which two points of the triangles come nearer than the clearance, for all kinds of
/// difficult pairs.
#[test]
fn no_bound_exceeds_a_z_at_which_points_are_near() {
    let mut attacked = [0; KINDS];
    for case in 0..cases(1300_u64) {
        let random = &mut Random::new(case + 2000);
        let kind = case as usize % KINDS;
        let model = random_pair(kind, random);
        let pair = reference(&model, [0, 1]);
        let at_rest = distance_triangle_triangle(&pair.triangle(0), &pair.triangle(1));
        let clearance = at_rest * random.power(-2.0, 0.0);
        if clearance <= 0.0 {
            continue;
        }
        let mut smallest = f64::INFINITY;
        for _ in 0..200 {
            let (d, b) = pair.relative([random.weights(), random.weights()]);
            let inverse = gram(&b).inverse();
            // The points come a little nearer than the clearance, so that rounding does not matter.
            let mut left = d;
            for _ in 0..8 {
                left = d - (inverse * left).normalize_or_zero() * (clearance * (1.0 - 1e-6));
            }
            let y = inverse * left;
            let z: Vec<f64> = b.iter().map(|b| -b.dot(y)).collect();
            let near = b.iter().zip(&z).fold(d, |x, (b, z)| x + *b * *z).length();
            let reach = pair.a.iter().flatten().map(|a| a.length()).fold(0.0, f64::max) * length(&z);
            let noise = 1e-12 * (pair.p.iter().map(|p| p.length()).fold(reach, f64::max));
            if near + noise < clearance * (1.0 - 1e-9) {
                smallest = smallest.min(length(&z));
            }
        }
        attacked[kind] += usize::from(smallest.is_finite());
        for (name, bound) in all_bounds_keeping(&model, clearance, random) {
            assert!(
                bound <= smallest * ROOM,
                "case {case}, kind {kind}: {name} {bound:e} above {smallest:e}"
            );
        }
        let bound = node_pair_bound_keeping(&model, clearance, 1);
        assert!(bound <= smallest * ROOM, "case {case}, kind {kind}: node pair {bound:e} above {smallest:e}");
    }
    assert!(attacked.iter().sum::<usize>() > cases(1300) / 2, "{attacked:?}");
}

/// Without a clearance the least gap is the rounding bound, bit for bit.
#[test]
fn without_a_clearance_the_least_gap_is_the_rounding_bound() {
    let random = &mut Random::new(5);
    for kind in 0..KINDS {
        let scaled = scaled_keeping(&random_pair(kind, random), 0.0);
        let dir = random.vector();
        let (least, rounding) = (scaled.least_gap(dir), scaled.rounding.along(dir));
        assert_eq!(
            [least.at_rest, least.per_norm].map(f64::to_bits),
            [rounding.at_rest, rounding.per_norm].map(f64::to_bits)
        );
    }
}
