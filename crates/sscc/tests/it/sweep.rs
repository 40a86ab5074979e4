//! Compares sweeps of single weights with brute force at many weights.

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{
    Certificates, CertifyOptions, Error, Impact, Method, ModeRange, Modes, MovingTriangle, Query,
    ReducedModel, Sweep, SweepOutcome, TriMesh,
};
use sscc_testing::{cases, distance, threshold};

use crate::common::{Random, after, random_model, random_options};

/// Returns two triangles in the planes z = 0 and z = height.
fn two_triangles(height: f64, place: DVec3, mode: impl Fn(usize) -> DVec3) -> ReducedModel {
    let triangle = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + place + DVec3::Z * z);
    let mesh = TriMesh::new([triangle(0.0), triangle(height)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    ReducedModel::new(mesh, Modes::new(1, (0..6).map(mode).collect()).unwrap()).unwrap()
}

fn certify(model: &ReducedModel) -> Certificates {
    Certificates::compute(model, &CertifyOptions::default(), &()).unwrap()
}

/// Checks that the bracket matches its outcome, and that brute force finds no collision below `first_free`.
pub(crate) fn check(sweep: &Sweep, model: &ReducedModel, q: &[f64], oracle: &mut Query, weights: usize) {
    let at = |w: f64| {
        let mut q = q.to_vec();
        q[sweep.mode] = w;
        q
    };
    let range = (sweep.to - sweep.from).abs();
    let Some(free) = sweep.first_free else {
        assert_eq!((sweep.outcome, sweep.first_hit), (SweepOutcome::CollidingAtStart, Some(sweep.from)));
        assert!(!sweep.pairs.is_empty());
        assert_eq!(oracle.discrete(&at(sweep.from)).unwrap(), sweep.pairs);
        return;
    };
    for i in 0..weights {
        // Half of the weights are near the end, where positions nearly touch.
        let share = i as f64 / (weights - 1).max(1) as f64;
        let share = if i % 2 == 0 { share } else { 1.0 - share.powi(30) * (1.0 - share) };
        let w = (sweep.from + share * (free - sweep.from)).clamp(free.min(sweep.from), free.max(sweep.from));
        let found = oracle.first(&at(w)).unwrap();
        assert_eq!(found, None, "mode {} at {w:?}, free up to {free:?}", sweep.mode);
    }
    assert_eq!(oracle.first(&at(free)).unwrap(), None, "{sweep:?}");
    let is_close = |hit: f64| {
        let next = if sweep.to > sweep.from { free.next_up() } else { free.next_down() };
        (hit - free).abs() <= 1e-9 * range || hit == next
    };
    match (sweep.outcome, sweep.first_hit) {
        (SweepOutcome::Free, None) => assert!(free == sweep.to && sweep.pairs.is_empty(), "{sweep:?}"),
        (SweepOutcome::Hit, Some(hit)) => {
            assert_eq!(oracle.discrete(&at(hit)).unwrap(), sweep.pairs, "{sweep:?}");
            assert!(!sweep.pairs.is_empty() && is_close(hit), "{sweep:?}");
        }
        (SweepOutcome::WithinTolerance, Some(hit)) => {
            assert!(!sweep.pairs.is_empty() && is_close(hit), "{sweep:?}");
            let corners = |t: u32| model.mesh().faces()[t as usize].map(|v| model.position(v, &at(hit)));
            let is_near = |pair: &(u32, u32)| {
                let [a, b] = [pair.0, pair.1].map(corners);
                let size = a.iter().chain(&b).map(|p| (*p - a[0]).abs().max_element()).fold(0.0, f64::max);
                let [x, y] = [a, b].map(|p| MovingTriangle { t0: p, t1: p });
                distance(&x, &y, 0.0) <= 2.0 * Impact::TOLERANCE * size
            };
            assert!(sweep.pairs.iter().any(is_near), "{sweep:?}");
        }
        (SweepOutcome::TooClose(_) | SweepOutcome::StepLimit, None) => assert!(sweep.pairs.is_empty()),
        (SweepOutcome::TooClose(_) | SweepOutcome::StepLimit, Some(hit)) => {
            assert_eq!(oracle.discrete(&at(hit)).unwrap(), sweep.pairs, "{sweep:?}");
        }
        other => panic!("{other:?}: {sweep:?}"),
    }
}

#[test]
fn brute_force_finds_nothing_below_first_free() {
    let (mut outcomes, mut weighed) = ([0; 5], 0);
    let weights = cases(10_000);
    for seed in 0..cases(200) {
        let model = random_model(seed + 40_000);
        let random = &mut Random::new(seed + 9_100_000);
        let options = random_options(seed, &model).epsilon(0.5);
        let limit = after(151);
        let Ok(certificates) = Certificates::compute(&model, &options, &limit) else { continue };
        let scope: &Scope = &certificates.parts().scope;
        let mut q = scope.center.clone();
        if seed % 3 == 0 {
            q.iter_mut().zip(scope.metric.scales()).for_each(|(q, s)| *q += 0.2 * random.signed() / s);
        }
        let query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        let mode = random.below(model.rank());
        let size = model.weight_limits()[mode] * random.power(-0.7, 0.5);
        let range = ModeRange { mode, low: q[mode] - size, high: q[mode] + size };
        let Ok(sweeps) = query.sweep_modes(&q, &[range], Some(1), &()) else { continue };
        for sweep in &sweeps {
            check(sweep, &model, &q, &mut oracle, weights);
            weighed += 1;
            outcomes[match sweep.outcome {
                SweepOutcome::Free => 0,
                SweepOutcome::CollidingAtStart => 1,
                SweepOutcome::Hit => 2,
                SweepOutcome::WithinTolerance => 3,
                _ => 4,
            }] += 1;
        }
        // Certificates do not change the result.
        let mut plain = Query::without_certificates(&model, scope.clone(), Method::BdTree).unwrap();
        for sweep in &sweeps {
            let mut at = q.clone();
            at[mode] = sweep.from;
            let other = plain.sweep(&at, mode, sweep.to).unwrap();
            assert_eq!(other.first_hit.is_some(), sweep.first_hit.is_some(), "{other:?} {sweep:?}");
            let (a, b) = (other.first_free.unwrap_or(sweep.from), sweep.first_free.unwrap_or(sweep.from));
            let is_exact = sweep.outcome == SweepOutcome::Hit && other.outcome == sweep.outcome;
            assert!(
                !is_exact || (a - b).abs() <= 3e-9 * (sweep.to - sweep.from).abs(),
                "{other:?} {sweep:?}"
            );
        }
    }
    let [free, start, hits, _, other] = outcomes;
    assert!(
        free > threshold(60) && hits > threshold(30) && start > threshold(20) && 20 * other <= weighed,
        "{outcomes:?}"
    );
}

#[test]
fn contacts_of_simple_shapes() {
    let lowered = |v: usize| if v < 3 { DVec3::ZERO } else { DVec3::NEG_Z };
    let model = two_triangles(1.0, DVec3::ZERO, lowered);
    let certificates = certify(&model);
    let mut query = Query::new(&model, &certificates).unwrap();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    for (from, to) in [(0.0, 3.0), (0.0, 1.0), (-7.0, 2.0), (3.0, 0.0), (2.0, 1.0), (0.999_999, 1e6)] {
        let sweep = query.sweep(&[from], 0, to).unwrap();
        check(&sweep, &model, &[from], &mut oracle, 1000);
        // The triangles touch only at 1.
        assert_eq!((sweep.outcome, sweep.first_hit), (SweepOutcome::Hit, Some(1.0)), "{sweep:?}");
        assert_eq!(sweep.pairs, [(0, 1)]);
    }
    for (from, to) in [(0.0, 1.0 - 1e-9), (0.0, -1e50), (1.0 + 1e-9, 2.0), (0.5, 0.5)] {
        let sweep = query.sweep(&[from], 0, to).unwrap();
        assert_eq!((sweep.outcome, sweep.first_free, sweep.first_hit), (SweepOutcome::Free, Some(to), None));
    }
    let sweep = query.sweep(&[1.0], 0, 2.0).unwrap();
    assert_eq!(
        (sweep.outcome, sweep.first_free, sweep.first_hit),
        (SweepOutcome::CollidingAtStart, None, Some(1.0))
    );

    // A triangle slides over the other one: its corner touches an edge only at the weight -1.
    let slides = |v: usize| if v < 3 { DVec3::ZERO } else { DVec3::X };
    let model = two_triangles(0.0, DVec3::ZERO, slides);
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
    let mut oracle = query.clone();
    let sweep = query.sweep(&[3.0], 0, -3.0).unwrap();
    check(&sweep, &model, &[3.0], &mut oracle, 1000);
    assert!(sweep.first_hit.is_some_and(|hit| (hit - 1.0).abs() < 1e-8), "{sweep:?}");

    // A corner moves past an edge, and touches it at 1/2.
    let p = [
        DVec3::new(-1.0, 0.0, 1.0),
        DVec3::new(-1.5, 1.0, 2.0),
        DVec3::new(-0.5, 1.0, 2.0),
        DVec3::new(-0.5, -1.0, 0.0),
        DVec3::new(-0.5, 1.0, 0.0),
        DVec3::new(-0.5, 0.0, 1.0),
    ];
    let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::new(1, (0..6).map(|v| if v < 3 { DVec3::X } else { DVec3::ZERO }).collect()).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let certificates = certify(&model);
    let mut query = Query::new(&model, &certificates).unwrap();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    for to in [1.0, 0.7, 0.5, 1e3] {
        let sweep = query.sweep(&[0.0], 0, to).unwrap();
        check(&sweep, &model, &[0.0], &mut oracle, 1000);
        let hit = sweep.first_hit.unwrap();
        assert!((hit - 0.5).abs() <= 2e-9 * to, "{sweep:?}");
        assert!(matches!(sweep.outcome, SweepOutcome::WithinTolerance | SweepOutcome::Hit), "{sweep:?}");
    }
}

/// Two triangles side by side far from the origin, at a distance of one unit in the last place, move together: in exact
/// arithmetic they stay separate, but at half a unit one is rounded up and the other one down.
#[test]
fn rounding_between_two_weights_is_not_forgotten() {
    let ulp = 2.0_f64.powi(-22);
    let at = |x: f64| [DVec3::ZERO, DVec3::Y, DVec3::Z].map(|p| p + DVec3::X * x);
    // An odd number of units.
    let place = 2.0_f64.powi(30) + ulp;
    let mesh = TriMesh::new([at(place), at(place + ulp)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, vec![DVec3::X; 6]).unwrap()).unwrap();
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::BdTree).unwrap();
    assert!(query.discrete(&[0.0]).unwrap().is_empty() && query.discrete(&[4.0 * ulp]).unwrap().is_empty());
    assert_eq!(query.discrete(&[0.5 * ulp]).unwrap(), [(0, 1)]);
    assert!(query.continuous(&[0.0], &[4.0 * ulp]).unwrap().is_empty());
    let sweep = query.sweep(&[0.0], 0, 4.0 * ulp).unwrap();
    assert!(sweep.first_free.is_some_and(|free| free < 0.5 * ulp), "{sweep:?}");
    assert_eq!((sweep.outcome, sweep.first_hit), (SweepOutcome::Hit, Some(0.5 * ulp)), "{sweep:?}");
    assert_eq!(sweep.pairs, [(0, 1)]);

    // The triangles are side by side along a diagonal, where AABBs do not separate them: nothing is proven.
    let at = |x: f64| [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::Z].map(|p| p + DVec3::X * x);
    let mesh = TriMesh::new([at(place), at(place + 2.0 * ulp)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, vec![DVec3::Z; 6]).unwrap()).unwrap();
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::BdTree).unwrap();
    let sweep = query.sweep(&[0.0], 0, 1.0).unwrap();
    assert_eq!((sweep.outcome, sweep.first_free), (SweepOutcome::TooClose((0, 1)), Some(0.0)), "{sweep:?}");
    assert_eq!((sweep.first_hit, sweep.pairs.len()), (None, 0));
}

#[test]
fn modes_are_swept_both_ways_from_their_weights() {
    let model = random_model(40_010);
    let certificates = certify(&model);
    let query = Query::new(&model, &certificates).unwrap();
    let rank = model.rank();
    let q = vec![0.01; rank];
    let ranges: Vec<ModeRange> = (0..rank).map(|mode| ModeRange { mode, low: -1.0, high: 2.0 }).collect();
    let sweeps = query.sweep_modes(&q, &ranges, None, &()).unwrap();
    assert_eq!(sweeps, query.sweep_modes(&q, &ranges, Some(1), &()).unwrap());
    let ways: Vec<(usize, f64, f64)> = sweeps.iter().map(|s| (s.mode, s.from, s.to)).collect();
    let expected: Vec<_> = (0..rank).flat_map(|k| [(k, 0.01, 2.0), (k, 0.01, -1.0)]).collect();
    assert_eq!(ways, expected);
    let ends = |[low, high]: [f64; 2]| -> Vec<(f64, f64)> {
        let found = query.sweep_modes(&q, &[ModeRange { mode: 0, low, high }], None, &()).unwrap();
        found.iter().map(|s| (s.from, s.to)).collect()
    };
    assert_eq!(ends([0.01, 0.5]), [(0.01, 0.5)]);
    assert_eq!(ends([-0.5, 0.01]), [(0.01, -0.5)]);
    assert_eq!(ends([0.1, 0.5]), [(0.1, 0.5)]);
    assert_eq!(ends([-0.5, -0.1]), [(-0.1, -0.5)]);

    for [low, high] in [[1.0, 1.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY], [f64::MIN, f64::MAX]] {
        let refused = query.sweep_modes(&q, &[ModeRange { mode: 0, low, high }], None, &());
        assert!(matches!(refused, Err(Error::SweepRange { mode: 0, .. })), "{refused:?}");
    }
    let refused = query.sweep_modes(&q, &[ModeRange { mode: rank, low: 0.0, high: 1.0 }], None, &());
    assert_eq!(refused, Err(Error::ModeIndex { mode: rank, rank }));
    assert!(matches!(query.sweep_modes(&[], &ranges, None, &()), Err(Error::CoordinatesLength { .. })));
    let mut single = query.clone();
    assert!(matches!(single.sweep(&q, 0, f64::NAN), Err(Error::CoordinatesValue { index: 0, .. })));
    assert_eq!(single.sweep(&q, rank, 1.0), Err(Error::ModeIndex { mode: rank, rank }));
    let stop = after(1);
    assert_eq!(query.sweep_modes(&q, &ranges, None, &stop), Err(Error::Cancelled));
}

#[test]
fn the_limit_of_a_weight_is_half_the_diagonal() {
    let model = two_triangles(2.0, DVec3::ONE, |v| if v < 3 { DVec3::ZERO } else { DVec3::Y * 3.0 });
    assert!((model.weight_limits()[0] - 6.0_f64.sqrt() / 6.0).abs() < 1e-15);
    assert!(two_triangles(2.0, DVec3::ONE, |_| DVec3::ZERO).weight_limits() == [1.0]);
}
