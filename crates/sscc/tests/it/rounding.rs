//! Answers that rounding decides: computed positions that touch although the exact ones are separate, and norms that equal a
//! radius.

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{
    Certificates, CertifyOptions, KineticQuery, Method, Metric, MetricKind, Modes, Query, ReducedModel,
    TriMesh,
};

use crate::common::Random;

/// Returns triangles one above the other at two heights, repeated side by side at a distance of 16; modes move each height up or
/// down as a whole.
fn stacked(times: u32, heights: [f64; 2], modes: &[[f64; 2]], metric: Option<Metric>) -> ReducedModel {
    let mut p = Vec::new();
    for z in heights {
        for i in 0..times {
            let corner = DVec3::new(16.0 * f64::from(i), 0.0, z);
            p.extend([DVec3::ZERO, DVec3::X, DVec3::Y].map(|x| corner + x));
        }
    }
    let faces = (0..2 * times).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let side = |v: usize| v / (3 * times as usize);
    let displacements = (0..p.len()).flat_map(|v| modes.iter().map(move |u| DVec3::Z * u[side(v)]));
    let modes = Modes::new(modes.len(), displacements.collect()).unwrap();
    let mesh = TriMesh::new(p, faces).unwrap();
    match metric {
        Some(metric) => ReducedModel::with_metric(mesh, modes, metric).unwrap(),
        None => ReducedModel::new(mesh, modes).unwrap(),
    }
}

/// Returns certificates with and without a pair tree.
fn certify(model: &ReducedModel, center: Option<Vec<f64>>) -> [Certificates; 2] {
    [0, 1 << 10].map(|budget| {
        let options = CertifyOptions::default().budget(budget).center(center.clone());
        Certificates::compute(model, &options, &()).unwrap()
    })
}

/// Returns whether the model collides at q, after a comparison of all certificates with brute force, and whether the root's
/// certificate alone proved it free.
fn ask(model: &ReducedModel, certificates: &[Certificates], q: &[f64]) -> (bool, bool) {
    let mut answers = (false, false);
    for certificates in certificates {
        let mut query = Query::new(model, certificates).unwrap();
        let mut oracle = Query::with_method(model, certificates, Method::BruteForce).unwrap();
        let expected = oracle.discrete(q).unwrap();
        assert_eq!(query.discrete(q).unwrap(), expected, "{q:?}, root {:e}", certificates.root_radius());
        answers = (!expected.is_empty(), query.statistics().root_certified);
    }
    answers
}

/// Two triangles meet at a |z| between two single-precision numbers, nearer to the upper one. The pair tree's radius is the
/// lower one.
#[test]
fn radii_in_single_precision_are_no_larger() {
    let random = &mut Random::new(1);
    for _ in 0..40 {
        let number = (1.0 + random.uniform()) as f32;
        let (below, above) = (f64::from(number), f64::from(number.next_up()));
        let gap = below + (above - below) * (0.55 + 0.4 * random.uniform());
        let model = stacked(9, [0.0, gap], &[[0.0, -1.0]], None);
        let certificates = certify(&model, None);
        for q in [gap.next_down(), gap - 1e-14, gap.next_down(), 0.5 * (gap + above), above.next_up()] {
            ask(&model, &certificates, &[q]);
        }
        assert!(ask(&model, &certificates, &[gap]).0);
        // The pairs that meet are in the tree, with the largest possible radius.
        let tree = &certificates[1].parts().pair_tree;
        assert!(tree.limit() > above && tree.entries().any(|(radius, _)| radius == number));
    }
}

/// Modes that move all vertices by 1e4 to 1e14 times the size cancel at the centre: partial sums are rounded, and two triangles
/// touch that are separate in exact arithmetic.
#[test]
fn positions_about_a_centre_are_rounded_on_the_way_there() {
    let random = &mut Random::new(2);
    let (mut certified, mut colliding) = (0, 0);
    for case in 0..60 {
        let far = random.power(4.0, 14.0);
        let unit = far.next_up() - far;
        // A third mode lowers the upper one; it comes first.
        let modes = [[0.0, -1.0], [far, far], [-far, -far]];
        let gap = unit * [0.6, 3.6, 40.0, 400.0, 4000.0][case % 5];
        let model = stacked(4, [0.0, gap], &modes, None);
        let certificates = certify(&model, Some(vec![0.0, 1.0, 1.0]));
        for share in [0.02, 0.1, 0.2, 0.3, 0.7, 0.9, 0.99] {
            let (collides, proven) = ask(&model, &certificates, &[share * gap, 1.0, 1.0]);
            certified += usize::from(proven);
            colliding += usize::from(collides);
        }
    }
    assert!(certified > 50 && colliding > 20, "{certified} {colliding}");
}

/// In this dense metric modes cancel, so that vertices hardly move: |A| is small, while |A||S||S^-1|, which bounds the rounding
/// of positions, is not.
#[test]
fn dense_metrics_bound_cancellation() {
    let random = &mut Random::new(3);
    let (mut certified, mut colliding) = (0, 0);
    for _ in 0..40 {
        let large = random.power(5.0, 10.0);
        // S^-1 takes (0, 0, z) to (0, -large z, z): up by -large z, and by large z again.
        let modes = [[0.0, -1e-9], [1.0, 1.0], [large, large]];
        let factor = vec![1.0, 0.0, 0.0, 0.0, 1.0, large, 0.0, 0.0, 1.0];
        let metric = Metric::from_factor(MetricKind::Given, 3, factor).unwrap();
        let model = stacked(4, [0.0, 0.9], &modes, Some(metric.clone()));
        let certificates = certify(&model, None);
        for exponent in 0..60 {
            let z = 2.0_f64.powi(exponent) / large;
            let (collides, proven) = ask(&model, &certificates, &metric.unscaled(&[0.0, 0.0, z]).unwrap());
            certified += usize::from(proven);
            colliding += usize::from(collides);
        }
    }
    assert!(certified > 100 && colliding > 20, "{certified} {colliding}");
}

/// Far from rest a kinetic query measures gaps that result from rounding: the computed distance of two triangles is one unit in
/// the last place, although they have moved towards each other by six tenths of it.
#[test]
fn kinetic_margins_know_that_positions_far_from_rest_are_rounded() {
    let random = &mut Random::new(4);
    let mut colliding = 0;
    for case in 0..20 {
        let far = random.power(4.0, 12.0);
        let unit = far.next_up() - far;
        let model = stacked(4, [0.0, 0.0], &[[0.0, 1.0], [1.0, 1.0]], Some(Metric::identity(2)));
        // The triangles touch at rest, and are separate further up, so certificates are about a nearby centre.
        let options = CertifyOptions::default().center(vec![1e3 * unit, 0.0]);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let gap = [0.6, 2.6, 30.6][case % 3];
        for step in 0..200 {
            let q = [unit * (gap - 0.01 * f64::from(step)), far];
            let expected = oracle.discrete(&q).unwrap();
            assert_eq!(kinetic.discrete(&q).unwrap(), expected, "case {case}, step {step}");
            colliding += usize::from(!expected.is_empty());
        }
    }
    assert!(colliding > 500, "{colliding}");
}

/// If pairs that collide at the centre are not exceptions, their radii are 0, which the norm 0 reaches.
#[test]
fn a_radius_of_nothing_proves_nothing_at_the_centre() {
    // Triangles that meet are in the same bucket or in different ones, because modes also separate nodes.
    for modes in [[0.0, 1.0], [1.0, 1.0]] {
        let model = stacked(40, [0.0, 0.0], &[modes], None);
        for budget in [0, 16, 1 << 12] {
            let options = CertifyOptions::default().max_exceptions(0).budget(budget).epsilon(0.5);
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            assert!(certificates.root_radius() == 0.0 && certificates.exceptions().is_empty());
            let mut query = Query::new(&model, &certificates).unwrap();
            assert_eq!(query.discrete(&[0.0]).unwrap().len(), 40, "{modes:?} {budget}");
            assert!(query.statistics().norm == 0.0 && !query.statistics().root_certified);
            assert_eq!(query.continuous(&[0.0], &[0.0]).unwrap().len(), 40);
        }
    }
}

/// A mode brings two triangles together along x, so slowly that the square of its rate underflows, while it moves both
/// sideways faster. Their gap is so small that they meet nevertheless.
#[test]
fn motions_whose_squares_underflow_are_no_rest() {
    let power = |exponent: i32| 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2);
    for (rate, aside, contact) in [(-540, -150, 139), (-545, -140, 130), (-600, -190, 150)] {
        let gap = power(rate + contact);
        let corners = [DVec3::ZERO, DVec3::Y, DVec3::Z];
        let positions = [0.0, gap].map(|x| corners.map(|p| p + DVec3::X * x)).concat();
        let aside = DVec3::Y * power(aside);
        let modes = [[aside; 3], [aside - DVec3::X * power(rate); 3]].concat();
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::new(1, modes).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
        let certificates = certify(&model, None);
        let mut colliding = 0;
        for share in [1e-30, 1e-9, 0.5, 0.999, 1.0] {
            colliding += usize::from(ask(&model, &certificates, &[share * power(contact)]).0);
        }
        assert_eq!(colliding, 1);
        assert!(certificates[0].root_radius() < power(contact));
    }
}

/// Far from the origin rounding closes the gap before the exact positions do.
#[test]
fn safe_scales_end_before_rounding_closes_a_gap() {
    let random = &mut Random::new(5);
    for _ in 0..60 {
        let far = random.power(1.0, 12.0);
        let unit = far.next_up() - far;
        let gap = unit * (4000.0 * (1.0 + random.uniform())).round();
        let model = stacked(1, [far, far + gap], &[[0.0, -1.0]], None);
        let mut query = Query::without_certificates(&model, Scope::of(&model), Method::BdTree).unwrap();
        let scale = query.safe_scale(&[2.0 * gap]).unwrap();
        for share in [1.0, 1.0 - 1e-15, 1.0 - 1e-4] {
            assert!(query.discrete(&[2.0 * gap * scale * share]).unwrap().is_empty(), "{far:e}: {scale}");
        }
        assert!(scale > 0.1 && scale < 0.5, "{scale}");
    }
}

/// At q = 1 each of many triangles, with its own motion, touches another one exactly: their AABBs, computed from positions in
/// single precision, must overlap.
#[test]
fn exact_contacts_are_found_in_single_precision() {
    let random = &mut Random::new(6);
    let (mut p, mut displacements) = (Vec::new(), Vec::new());
    for i in 0..300 {
        let corner = DVec3::new(3.0 * f64::from(i % 20), 3.0 * f64::from(i / 20), random.signed());
        let gap = random.uniform();
        p.extend([DVec3::ZERO, DVec3::X, DVec3::Y].map(|x| corner + x));
        p.extend([DVec3::ZERO, DVec3::X, DVec3::Y].map(|x| corner + x + DVec3::Z * gap));
        let moved = p[6 * i as usize + 3].z - corner.z;
        displacements.extend([0.0, 0.0, 0.0, -moved, -moved, -moved].map(|z| DVec3::Z * z));
    }
    let faces = (0..600).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let modes = Modes::new(1, displacements).unwrap();
    let model = ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap();
    for method in [Method::BruteForce, Method::BdTree, Method::Traditional] {
        let mut query = Query::without_certificates(&model, Scope::of(&model), method).unwrap();
        assert_eq!(query.discrete(&[1.0]).unwrap().len(), 300, "{method:?}");
        assert_eq!(query.continuous(&[0.5], &[1.0]).unwrap().len(), 300, "{method:?}");
    }
}
