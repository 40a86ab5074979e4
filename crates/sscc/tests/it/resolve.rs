//! Free configurations near colliding ones are checked by brute force.

use glam::DVec3;
use sscc::{
    Certificates, CertifyOptions, Error, Method, Metric, Modes, Pair, Query, ReducedModel, ResolveOptions,
    Resolved, TriMesh,
};
use sscc_testing::{cases, threshold};

use crate::common::{Random, after, at, random_model, random_options};

#[test]
fn answers_are_free_and_no_farther_than_stepping_back() {
    let (mut resolved, mut nearer, mut none, mut left) = (0, 0, 0, 0);
    for seed in 0..cases(240) {
        let model = random_model(seed);
        let random = &mut Random::new(seed + 5_000_000);
        let options = random_options(seed, &model).epsilon(0.5);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else {
            continue;
        };
        let scope = &certificates.parts().scope;
        let mut query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        let all = seed % 3 == 0;
        let options = ResolveOptions::default().all(all);
        let counts = |pair: &Pair| all || scope.exceptions.binary_search(pair).is_err();
        for _ in 0..2 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * random.power(-2.0, 1.0)).collect();
            let q = at(scope, &z);
            let Ok(found) = query.resolve(&q, &options) else { continue };
            let Some(free) = &found.q else {
                assert!(oracle.discrete(&scope.center).unwrap().iter().any(counts), "model {seed}");
                assert_eq!((found.change, found.safe_scale_change), (f64::INFINITY, f64::INFINITY));
                none += 1;
                continue;
            };
            assert!(!oracle.discrete(free).unwrap().iter().any(counts), "model {seed}: {q:?} {free:?}");
            left += usize::from(!oracle.discrete(free).unwrap().is_empty());
            let is_free = !oracle.discrete(&q).unwrap().iter().any(counts);
            assert_eq!(is_free, *free == q && found.change == 0.0, "model {seed}");
            if is_free {
                assert_eq!(found.safe_scale_change, 0.0);
                continue;
            }
            let way: Vec<f64> = free.iter().zip(&q).map(|(a, b)| a - b).collect();
            let distance = scope.metric.norm(&way).unwrap();
            assert!((found.change - distance).abs() <= 1e-9 * distance, "model {seed}");
            assert!(found.change <= found.safe_scale_change, "model {seed}: {found:?}");
            // Stepping back to the safe scale does not change q by less.
            if scope.exceptions.is_empty() {
                let scale = query.safe_scale(&q).unwrap().min(1.0);
                let left = (1.0 - scale) * certificates.norm(&q).unwrap();
                assert!(found.safe_scale_change <= left * (1.0 + 1e-6), "model {seed}: {found:?} {left}");
            }
            resolved += 1;
            nearer += usize::from(found.change < 0.7 * found.safe_scale_change);
        }
    }
    let seen = (resolved, nearer, none, left);
    assert!(
        resolved > threshold(60) && nearer > threshold(20) && none > threshold(8) && left >= threshold(4),
        "{seen:?}"
    );
}

/// Returns a spike at a distance of 1 above a plate: mode 0 lowers it, mode 1 shifts it along the plate. The metric is the identity.
fn spike() -> ReducedModel {
    let plate = [DVec3::new(-9.0, -9.0, 0.0), DVec3::new(9.0, -9.0, 0.0), DVec3::new(0.0, 9.0, 0.0)];
    let spike = [DVec3::new(0.0, 0.0, 1.0), DVec3::new(-0.1, 0.0, 6.0), DVec3::new(0.1, 0.0, 6.0)];
    let mesh = TriMesh::new([plate, spike].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let entry = |row: usize, k: usize| match (row >= 9, row % 3, k) {
        (true, 2, 0) => -1.0,
        (true, 0, 1) => 1.0,
        _ => 0.0,
    };
    let modes = Modes::from_matrix(6, 2, entry).unwrap();
    ReducedModel::with_metric(mesh, modes, Metric::identity(2)).unwrap()
}

#[test]
fn answers_slide_along_an_obstacle() {
    let model = spike();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    let resolve = |query: &mut Query, q: [f64; 2], start: Option<Vec<f64>>| {
        query.resolve(&q, &ResolveOptions::default().start(start).all(false)).unwrap()
    };
    // The straight line is free until (1, 0.4); the tip stays above the plate, and the shift reaches that of q.
    let found = resolve(&mut query, [2.5, 1.0], None);
    let q = found.q.unwrap();
    assert!(q[0] < 1.0 && q[0] > 1.0 - 1e-3 && (q[1] - 1.0).abs() < 1e-3, "{q:?}");
    assert!((found.change - 1.5).abs() < 1e-3 && (found.safe_scale_change - 1.5_f64.hypot(0.6)).abs() < 1e-6);
    // From a start below, the answer is on the other side of the plate.
    let q = resolve(&mut query, [5.5, 1.0], Some(vec![7.0, 0.0])).q.unwrap();
    assert!(q[0] > 6.0 && q[0] < 6.0 + 1e-3 && (q[1] - 1.0).abs() < 1e-3, "{q:?}");
    // A free q is returned unchanged, also beyond the plate.
    for q in [[0.5, 3.0], [6.5, 0.0]] {
        let expected = Resolved { q: Some(q.to_vec()), change: 0.0, safe_scale_change: 0.0 };
        assert_eq!(resolve(&mut query, q, None), expected);
    }
}

#[test]
fn invalid_input_is_refused() {
    let model = spike();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    let mut resolve = |q: &[f64], start: Option<Vec<f64>>| {
        query.resolve(q, &ResolveOptions::default().start(start).all(false)).map(|_| ()).unwrap_err()
    };
    assert!(matches!(resolve(&[1.0], None), Error::CoordinatesLength { found: 1, rank: 2 }));
    assert!(matches!(resolve(&[1.0, f64::NAN], None), Error::CoordinatesValue { index: 1, .. }));
    assert!(matches!(resolve(&[1e300, 0.0], None), Error::CoordinatesRange));
    assert!(matches!(resolve(&[1.5, 0.0], Some(vec![0.0])), Error::CoordinatesLength { .. }));
    assert!(matches!(resolve(&[1.5, 0.0], Some(vec![f64::INFINITY, 0.0])), Error::CoordinatesValue { .. }));
    // A start that collides is an error, also if q is free.
    for q in [[1.5, 0.0], [0.0, 0.0]] {
        assert_eq!(resolve(&q, Some(vec![2.0, 0.0])), Error::ResolveStart);
    }
    assert!(matches!(Modes::new(0, Vec::new()), Err(Error::RankZero)));
    assert!(matches!(Modes::new((1 << 20) + 1, Vec::new()), Err(Error::Option { .. })));
    // A q far beyond the plate is free, so it is returned unchanged.
    let far = query.resolve(&[1e50, 0.0], &ResolveOptions::default()).unwrap();
    assert_eq!(far.change, 0.0);
}

#[test]
fn exceptions_may_collide_unless_all_pairs_count() {
    let model = spike();
    let options = CertifyOptions::default().center(vec![2.0, 0.0]);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    assert_eq!(certificates.exceptions(), [(0, 1)]);
    let mut query = Query::new(&model, &certificates).unwrap();
    let q = [2.5, 0.5];
    let found = query.resolve(&q, &ResolveOptions::default()).unwrap();
    assert_eq!((found.q.as_deref(), found.change), (Some(&q[..]), 0.0));
    let all = ResolveOptions::default().all(true);
    let found = query.resolve(&q, &all).unwrap();
    assert!(!found.is_resolved() && found.change.is_infinite(), "{found:?}");
    // The centre collides, but q is free.
    assert!(query.resolve(&[0.5, 0.5], &all).unwrap().is_resolved());
    let from_above = ResolveOptions::default().start(vec![0.0, 0.0]).all(true);
    let found = query.resolve(&q, &from_above).unwrap();
    assert!(query.discrete(&found.q.unwrap()).unwrap().is_empty());
    // Without exceptions a colliding centre cannot be the start, either.
    let options = options.max_exceptions(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    assert!(!query.resolve(&q, &ResolveOptions::default()).unwrap().is_resolved());
}

#[test]
fn batches_and_samples() {
    let model = spike();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    let random = &mut Random::new(4);
    let draws: Vec<Vec<f64>> = (0..60).map(|_| vec![2.0 * random.signed(), 2.0 * random.signed()]).collect();
    let options = ResolveOptions::default();
    let one = query.resolve_batch(&draws, &options, Some(1), &()).unwrap();
    assert_eq!(one, query.resolve_batch(&draws, &options, Some(3), &()).unwrap());
    for (q, found) in draws.iter().zip(&one) {
        assert_eq!(*found, query.resolve(q, &options).unwrap());
    }
    let free = draws.iter().filter(|q| query.first(q).unwrap().is_none()).count();
    assert!(free > 10 && free < 50);

    let samples = query.free_samples(&draws, Some(&options), None, &()).unwrap();
    assert_eq!((samples.drawn, samples.free, samples.q.len()), (60, free, 60));
    assert!((samples.acceptance() - free as f64 / 60.0).abs() < 1e-12);
    assert_eq!(samples.changes.iter().filter(|change| **change == 0.0).count(), free);
    assert!(samples.q.iter().all(|q| query.first(q).unwrap().is_none()));

    let samples = query.free_samples(&draws, None, None, &()).unwrap();
    assert_eq!((samples.drawn, samples.free, samples.q.len()), (60, free, free));
    assert!(samples.q.iter().zip(&samples.draws).all(|(q, draw)| *q == draws[*draw]));

    assert_eq!(query.resolve_batch(&draws, &options, None, &after(6)), Err(Error::Cancelled));
    assert_eq!(query.free_samples(&draws, None, None, &after(6)), Err(Error::Cancelled));
    let nothing: [Vec<f64>; 0] = [];
    assert!(query.free_samples(&nothing, None, None, &()).unwrap().acceptance().is_nan());
    let invalid = [vec![0.0, 0.0], vec![f64::NAN, 0.0]];
    assert!(matches!(
        query.resolve_batch(&invalid, &options, None, &()),
        Err(Error::CoordinatesValue { .. })
    ));
}
