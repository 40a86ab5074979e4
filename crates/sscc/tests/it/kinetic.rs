//! Compares kinetic queries with brute force, which uses none of their AABBs and tests in single precision, at every step of motions of
//! all kinds.

use glam::DVec3;
use sscc::{
    Certificates, CertifyOptions, ContactFilter, KineticQuery, Method, Metric, MetricKind, Modes, Neighbours,
    Query, ReducedModel, TriMesh,
};
use sscc_testing::{cases, threshold};

use crate::common::{Random, at, random_model, random_options};

/// The numbers of compared steps, of steps with collisions, of steps at which fewer triangles were tested than by a query
/// with certificates, and of pairs.
#[derive(Debug, Default)]
struct Counts {
    steps: usize,
    colliding: usize,
    lasting: usize,
    pairs: usize,
}

/// Returns a motion in z, in units of `size`: random walks, vibrations, jumps, returns, rest, or repeated q.
fn motion(random: &mut Random, rank: usize, kind: usize, steps: usize, size: f64) -> Vec<Vec<f64>> {
    let start: Vec<f64> = (0..rank).map(|_| random.signed() * size).collect();
    let waves: Vec<[f64; 3]> =
        (0..rank).map(|k| [random.signed(), random.power(-4.5, -2.5), random.uniform() * k as f64]).collect();
    let vibration = |i: usize| -> Vec<f64> {
        waves.iter().map(|[a, w, phase]| size * a * (w * i as f64 + phase).sin()).collect()
    };
    let mut z = start.clone();
    let stride = random.power(-5.0, -3.0) * size;
    (0..steps)
        .map(|i| {
            match kind {
                // A random walk, with stops.
                0 if random.below(8) > 0 => z.iter_mut().for_each(|z| *z += random.signed() * stride),
                0 => {}
                // Vibrations.
                1 | 2 => z = vibration(i),
                // Vibrations with jumps elsewhere and back, and to rest.
                3 => {
                    z = match i % 50 {
                        20 => start.clone(),
                        35 | 36 => vec![0.0; rank],
                        45 => z.iter().map(|_| random.signed() * size).collect(),
                        _ => vibration(i),
                    }
                }
                // A straight motion and back along the same points.
                _ => {
                    let t = 1.0 - 0.1 * (i % 80).abs_diff(40) as f64 / 40.0;
                    z = start.iter().map(|x| x * t).collect();
                }
            }
            z.clone()
        })
        .collect()
}

fn compare(model: &ReducedModel, certificates: &Certificates, path: &[Vec<f64>], counts: &mut Counts) {
    let mut oracle = Query::with_method(model, certificates, Method::BruteForce).unwrap();
    let mut full = Query::new(model, certificates).unwrap();
    let mut kinetic = KineticQuery::new(model, certificates).unwrap();
    for (step, z) in path.iter().enumerate() {
        let q = at(&certificates.parts().scope, z);
        match oracle.discrete(&q) {
            Ok(expected) => {
                assert_eq!(kinetic.discrete(&q).unwrap(), expected, "step {step}");
                full.discrete(&q).unwrap();
                assert_eq!(kinetic.statistics().norm, full.statistics().norm);
                assert_eq!(kinetic.pairs(), expected);
                assert!(kinetic.statistics().complete);
                counts.steps += 1;
                counts.colliding += usize::from(!expected.is_empty());
                counts.lasting += usize::from(
                    kinetic.statistics().triangle_tests < full.statistics().triangle_tests
                        || kinetic.statistics().box_tests < full.statistics().box_tests,
                );
                counts.pairs += expected.len();
            }
            Err(error) => assert_eq!(kinetic.discrete(&q).unwrap_err(), error),
        }
    }
}

#[test]
fn small_models_of_every_kind() {
    let mut counts = Counts::default();
    for seed in 0..cases(120) {
        let model = random_model(seed);
        let options = random_options(seed, &model).budget(1 << 14);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let random = &mut Random::new(seed + 400_000);
        let limit = certificates.parts().pair_tree.limit();
        let scale = if limit > 0.0 && random.below(4) > 0 { limit * 0.7 } else { 1.0 };
        let size = scale * random.power(-1.0, 0.3) / (model.rank() as f64).sqrt();
        let path = motion(random, model.rank(), seed as usize % 5, 120, size);
        compare(&model, &certificates, &path, &mut counts);
    }
    assert!(
        counts.steps > threshold(10_000)
            && counts.colliding > threshold(1000)
            && counts.lasting > threshold(500),
        "{counts:?}"
    );
}

/// Returns a coil of a band, of several buckets; some of its corners have new vertices.
fn coil(random: &mut Random, seed: u64) -> ReducedModel {
    let (steps, turns) = (90 + random.below(80), 2.0 + 2.0 * random.uniform());
    let pitch = 0.25 + 0.1 * random.uniform();
    let mut p: Vec<DVec3> = (0..=steps)
        .flat_map(|i| {
            let s = turns * std::f64::consts::TAU * i as f64 / steps as f64;
            let (sin, cos) = s.sin_cos();
            let x = DVec3::new(cos, sin, pitch * s / std::f64::consts::TAU);
            [x, x + DVec3::Z * 0.08, x * DVec3::new(0.9, 0.9, 1.0) + DVec3::Z * 0.04]
        })
        .collect();
    let quad = |a: u32, b: u32| [[a, a + 3, b], [b, a + 3, b + 3]];
    let mut faces: Vec<[u32; 3]> = (0..steps as u32)
        .map(|i| 3 * i)
        .flat_map(|i| [quad(i, i + 1), quad(i + 1, i + 2), quad(i + 2, i)].concat())
        .collect();
    if seed.is_multiple_of(3) {
        for corner in faces.iter_mut().flatten().filter(|_| random.below(6) == 0) {
            p.push(p[*corner as usize]);
            *corner = p.len() as u32 - 1;
        }
    }
    let rank = 2 + random.below(5);
    let ways: Vec<[DVec3; 2]> = (0..rank).map(|_| [random.vector(), random.vector() * 2.0]).collect();
    let bend = |x: DVec3| {
        ways.iter().enumerate().map(move |(k, [way, along])| {
            if k == 0 { DVec3::Z * x.z * 0.3 } else { *way * (x.dot(*along)).sin() * 0.3 }
        })
    };
    let modes = Modes::new(rank, p.iter().flat_map(|x| bend(*x)).collect()).unwrap();
    let mesh = TriMesh::new(p, faces).unwrap();
    let metric = match seed % 4 {
        0 => Metric::displacement(&mesh, &modes).unwrap(),
        1 => Metric::identity(rank),
        _ => {
            let entry = |i: usize, j: usize| match i.cmp(&j) {
                std::cmp::Ordering::Less => 0.4 * random.signed(),
                std::cmp::Ordering::Equal => 1.0 + random.uniform(),
                std::cmp::Ordering::Greater => 0.0,
            };
            let mut entry = entry;
            let factor = (0..rank * rank).map(|e| entry(e / rank, e % rank)).collect();
            Metric::from_factor(MetricKind::Given, rank, factor).unwrap()
        }
    };
    ReducedModel::with_metric(mesh, modes, metric).unwrap()
}

#[test]
fn answers_of_coils_are_those_of_brute_force() {
    let mut counts = Counts::default();
    for seed in 0..cases(16) {
        let random = &mut Random::new(seed + 600_000);
        let model = coil(random, seed);
        let rank = model.rank();
        let options = CertifyOptions::default()
            .epsilon(0.5)
            .center((seed % 5 == 1).then(|| (0..rank).map(|_| random.signed() * 0.05).collect()))
            .filter(
                ContactFilter::new(
                    [Neighbours::Exclude, Neighbours::IncludeOneVertex][seed as usize / 2 % 2],
                )
                .weld(seed % 3 == 0 && seed % 2 == 0),
            )
            .budget([1 << 12, 64][usize::from(seed % 7 == 3)])
            // The limit, which determines the size of the motion, stays near contact.
            .reach(1.0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let limit = certificates.parts().pair_tree.limit();
        let size = 0.8 * limit * random.power(-0.5, 0.2) / (rank as f64).sqrt();
        for kind in 0..5 {
            let path = motion(random, rank, kind, 120, size);
            compare(&model, &certificates, &path, &mut counts);
        }
    }
    assert!(
        counts.steps > threshold(9000)
            && counts.colliding > threshold(900)
            && counts.lasting > threshold(1000),
        "{counts:?}"
    );
}

#[test]
fn answers_after_an_error_are_right() {
    let model = coil(&mut Random::new(1), 1);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    for step in 0..60 {
        let t = -0.9 + f64::from(step) * 1e-4;
        let mut q = vec![0.0; model.rank()];
        q[0] = t;
        assert_eq!(kinetic.discrete(&q).unwrap(), oracle.discrete(&q).unwrap());
        if step % 7 == 0 {
            assert!(kinetic.discrete(&[f64::NAN]).is_err());
            assert_eq!(kinetic.pairs(), []);
            q[1] = f64::INFINITY;
            assert!(kinetic.discrete(&q).is_err());
        }
    }
}

/// With a mode without displacements, norms and regions can have any size.
#[test]
fn regions_of_any_size_are_searched() {
    for triangles in [3_u32, 40, 700] {
        let random = &mut Random::new(u64::from(triangles));
        let positions: Vec<DVec3> = (0..3 * triangles)
            .map(|v| {
                let place = f64::from(v / 3) * 0.3;
                DVec3::new(place + random.signed(), random.signed(), random.signed())
            })
            .collect();
        let faces = (0..triangles).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let displacements = positions.iter().flat_map(|p| [*p * 0.1, DVec3::ZERO]).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let metric = Metric::from_scales(MetricKind::Given, vec![1.0; 2]).unwrap();
        let model = ReducedModel::with_metric(mesh, Modes::new(2, displacements).unwrap(), metric).unwrap();
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let mut plain = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        for far in [1.0, 1e38, 1e39, 1e41, 1e45, 1e100] {
            let mut query = KineticQuery::new(&model, &certificates).unwrap();
            for step in 0..6 {
                let q = [0.5 + 1e-6 * f64::from(step), far];
                assert_eq!(query.discrete(&q).unwrap(), plain.discrete(&q).unwrap(), "{triangles}, {far}");
            }
        }
    }
}
