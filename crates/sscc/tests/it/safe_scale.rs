//! Tests of safe scales and of the root's ellipsoid.

use glam::DVec3;
use sscc::parts::{CertificateParts, PairTree, Scope};
use sscc::{Certificates, CertifyOptions, Error, Method, Metric, Modes, Query, ReducedModel, TriMesh};
use sscc_testing::{cases, threshold};

use crate::common::{Random, after, at, random_model, random_options, winding_strip};

#[test]
fn shapes_up_to_the_safe_scale_are_free() {
    let (mut tried, mut larger, mut tight, mut stopped) = (0, 0, 0, 0);
    for seed in 0..cases(400) {
        let model = random_model(seed);
        let random = &mut Random::new(seed + 7_000_000);
        let options = random_options(seed, &model).epsilon(0.5);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else { continue };
        let scope = &certificates.parts().scope;
        let mut query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        for _ in 0..3 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * random.power(-2.0, 2.0)).collect();
            let q = at(scope, &z);
            let Ok(scale) = query.safe_scale(&q) else { continue };
            let along =
                |t: f64| -> Vec<f64> { scope.center.iter().zip(&q).map(|(c, q)| c + t * (q - c)).collect() };
            assert!(scale >= 0.0, "model {seed}: {scale}");
            tried += 1;
            let root = certificates.root_radius() / query.statistics().norm;
            if scope.exceptions.is_empty() {
                assert!(scale >= root * (1.0 - 1e-12), "model {seed}: {scale} {root}");
                larger += usize::from(scale > 1.01 * root);
            } else {
                // These models collide at the centre.
                assert_eq!(scale, 0.0, "model {seed}");
            }
            let last = if scale.is_finite() { scale } else { random.power(-3.0, 3.0) };
            if scale > 0.0 {
                for share in [1.0, 1.0 - 1e-15, 1.0 - 1e-9, 0.999, random.uniform(), random.uniform(), 0.0] {
                    let Ok(found) = oracle.discrete(&along(last * share)) else { continue };
                    assert!(found.is_empty(), "model {seed}: {found:?} at {share} of {scale}");
                }
            } else {
                stopped += 1;
            }
            let beyond = oracle.discrete(&along(last * 1.02));
            tight += usize::from(beyond.is_ok_and(|found| !found.is_empty()));
        }
    }
    assert!(
        tried > threshold(600)
            && larger > threshold(200)
            && tight > threshold(200)
            && stopped > threshold(30),
        "{tried} {larger} {tight} {stopped}"
    );
}

/// A scale that is a subnormal number does not keep the search from its end.
#[test]
fn the_smallest_scales_end() {
    let small = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * 1e-14);
    let positions = [small, small.map(|p| p + DVec3::Z * 1e-14)].concat();
    let moved = |v: u32| if v < 3 { [DVec3::ZERO; 2] } else { [DVec3::NEG_Z, DVec3::NEG_Z * 1e-300] };
    let modes = Modes::new(2, (0..6).flat_map(moved).collect()).unwrap();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(2)).unwrap();
    let options = CertifyOptions::default().local_budget(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap().cancelled_by(after(1000));
    let scale = query.safe_scale(&[0.0, 1e308]).unwrap();
    assert!((0.0..1e-322).contains(&scale), "{scale:e}");
}

/// Radii of pairs of nodes are further proofs; conservative advancement then begins at another scale, which changes its end by
/// less than its smallest step.
#[test]
fn the_pair_tree_shortens_no_scale() {
    let (mut compared, mut opened) = (0, [0, 0]);
    for seed in 0..cases(40) {
        let random = &mut Random::new(seed + 9_000_000);
        let model = winding_strip(random, seed);
        let options = random_options(seed, &model).epsilon(0.5);
        let full = Certificates::compute(&model, &options, &()).unwrap();
        if full.parts().pair_tree.is_empty() {
            continue;
        }
        let parts = CertificateParts { pair_tree: PairTree::default(), ..full.parts().clone() };
        let paper = Certificates::try_from(parts).unwrap();
        let mut queries = [&paper, &full].map(|certificates| Query::new(&model, certificates).unwrap());
        for _ in 0..5 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * random.power(-2.0, 2.0)).collect();
            let q = at(&full.parts().scope, &z);
            let [Ok(before), Ok(after)] = queries.each_mut().map(|query| query.safe_scale(&q)) else {
                continue;
            };
            assert!(after >= before * (1.0 - 2e-4), "model {seed}: {after} after {before}");
            compared += 1;
            opened.iter_mut().zip(&queries).for_each(|(n, query)| *n += query.statistics().opened);
        }
    }
    assert!(compared > threshold(50) && opened[1] < opened[0], "{compared} {opened:?}");
}

#[test]
fn scales_of_simple_shapes() {
    let triangle = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z);
    let mesh = TriMesh::new([triangle(0.0), triangle(1.0)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let lowered = |row: usize, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
    let model = ReducedModel::new(mesh, Modes::from_matrix(6, 1, lowered).unwrap()).unwrap();
    let within = |reach| {
        let options = CertifyOptions::default().reach(reach);
        Certificates::compute(&model, &options, &()).unwrap()
    };
    let certificates = within(1.0);
    let mut query = Query::new(&model, &certificates).unwrap();
    // The global radius is rounded down to single precision.
    let near = |x: f64, goal: f64| x <= goal && x > goal * (1.0 - 2e-7);
    assert!(near(certificates.global_radius(), 3.0_f64.sqrt() / 2.0));
    // The global radius, half the diagonal of the box, is smaller than the contact.
    assert!(near(query.safe_scale(&[1.0]).unwrap(), certificates.global_radius()));
    assert!(near(query.safe_scale(&[-2.0]).unwrap(), certificates.global_radius() / 2.0));
    assert_eq!(query.safe_scale(&[0.0]).unwrap(), f64::INFINITY);
    // With a larger reach, scales end at the contact, or, away from the contact, at the largest radius.
    let farther = within(4.0);
    let mut query = Query::new(&model, &farther).unwrap();
    assert_eq!(farther.global_radius(), 4.0 * certificates.global_radius());
    assert!(near(query.safe_scale(&[1.0]).unwrap(), 1.0));
    assert!(near(query.safe_scale(&[-2.0]).unwrap(), 2.0 * certificates.global_radius()));
    // Without certificates there is no global radius: scales end at the contact, or at the range of numbers.
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
    assert!(near(query.safe_scale(&[1.0]).unwrap(), 1.0));
    assert!(near(query.safe_scale(&[4.0]).unwrap(), 0.25));
    let scale = query.safe_scale(&[-1.0]).unwrap();
    assert!(scale > 1e50 && query.discrete(&[-scale]).is_ok(), "{scale:e}");
    assert!(matches!(query.safe_scale(&[f64::NAN]), Err(Error::CoordinatesValue { .. })));
    assert!(query.safe_scale(&[1.0, 1.0]).is_err());
}

#[test]
fn clamping_ends_inside_the_root_ellipsoid() {
    let (mut clamped, mut none) = (0, 0);
    for seed in 0..cases(150) {
        let model = random_model(seed);
        let random = &mut Random::new(seed + 8_000_000);
        let options = random_options(seed, &model).epsilon(0.9);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else { continue };
        let scope = &certificates.parts().scope;
        let mut query = Query::new(&model, &certificates).unwrap();
        for size in [1e-200, 1e-3, 1.0, 1e9, 1e300] {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * size).collect();
            let q = at(scope, &z);
            if q.iter().any(|x| !x.is_finite()) {
                continue;
            }
            let Some(inside) = certificates.clamp(&q).unwrap() else {
                assert!(certificates.root_radius() <= 0.0 || !certificates.exceptions().is_empty());
                none += 1;
                continue;
            };
            assert_eq!(certificates.clamp(&inside).unwrap().as_ref(), Some(&inside), "model {seed}");
            if query.discrete(&inside).is_ok() {
                assert!(
                    query.statistics().root_certified && query.pairs().is_empty(),
                    "model {seed} {size:e}"
                );
            }
            if inside != q {
                clamped += 1;
            }
        }
        assert!(certificates.clamp(&vec![f64::NAN; model.rank()]).is_err());
        assert!(certificates.clamp(&vec![0.0; model.rank() + 1]).is_err());
    }
    assert!(clamped > threshold(100) && none > threshold(20), "{clamped} {none}");
}

/// If quotients underflow, the scale is too small rather than too large.
#[test]
fn tiny_gaps_and_large_motions() {
    for (gap, size, q) in
        [(1e-262, 1e-262, 1e55), (1e-304, 1e-3, 1e20), (1e-300, 1.0, 1.0), (1e59, 1e60, 1.0)]
    {
        let triangle = |z: f64| [DVec3::ZERO, DVec3::X * size, DVec3::Y * size].map(|p| p + DVec3::Z * z);
        let mesh = TriMesh::new([triangle(0.0), triangle(gap)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let lowered = |row: usize, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
        let modes = Modes::from_matrix(6, 1, lowered).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, sscc::Metric::identity(1)).unwrap();
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let mut query = Query::new(&model, &certificates).unwrap();
        let mut plain = Query::without_certificates(&model, Scope::of(&model), Method::BdTree).unwrap();
        for query in [&mut query, &mut plain] {
            let scale = query.safe_scale(&[q]).unwrap();
            assert!(!query.discrete(&[gap]).unwrap().is_empty());
            assert!((0.0..=gap / q).contains(&scale), "{gap:e} {size:e} {q:e}: {scale:e}");
        }
    }
}
