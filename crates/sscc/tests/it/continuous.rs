//! Compares continuous queries with brute force, with discrete queries during the motion, and with known times.

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{
    Certificates, CertifyOptions, Error, Impact, Method, Modes, MovingTriangle, Pair, Query, ReducedModel,
    TriMesh, impact_triangle_triangle,
};
use sscc_testing::{cases, threshold};

use crate::common::{Random, after, at, random_model, random_options};

fn certify(model: &ReducedModel, options: CertifyOptions) -> Option<Certificates> {
    let options = options.epsilon(0.5);
    Certificates::compute(model, &options, &after(601)).ok()
}

fn pairs(impacts: &[Impact]) -> Vec<Pair> {
    impacts.iter().map(|impact| impact.pair).collect()
}

#[test]
fn all_methods_agree_and_miss_nothing() {
    let (mut compared, mut hits, mut certified, mut sampled, mut between) = (0, 0, 0, 0, 0);
    for seed in 0..cases(200) {
        let model = random_model(seed);
        let random = &mut Random::new(seed + 9_000_000);
        let Some(certificates) = certify(&model, random_options(seed, &model)) else { continue };
        let scope = &certificates.parts().scope;
        let query = |method| Query::with_method(&model, &certificates, method).unwrap();
        let mut queries = [Method::Certified, Method::BdTree, Method::Traditional].map(query);
        let mut oracle = query(Method::BruteForce);
        let root = certificates.root_radius();
        let root = if root.is_finite() && root > 0.0 { root } else { 1.0 };
        for _ in 0..4 {
            let size = root * random.power(-1.5, 1.0);
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * size).collect();
            let step = size * random.power(-4.0, 0.5);
            let other: Vec<f64> = z.iter().map(|z| z + random.signed() * step).collect();
            let (q_t0, q_t1) = (at(scope, &z), at(scope, &other));
            let Ok(expected) = oracle.continuous(&q_t0, &q_t1) else { continue };
            let expected = expected.to_vec();
            assert!(expected.iter().all(|impact| (0.0..=1.0).contains(&impact.time)), "model {seed}");
            for query in &mut queries {
                let found = query.continuous(&q_t0, &q_t1).unwrap();
                assert_eq!(found, expected, "model {seed}");
                assert_eq!(query.pairs(), pairs(&expected));
                assert!(query.statistics().complete);
            }
            certified += usize::from(queries[0].statistics().root_certified);
            compared += 1;
            hits += usize::from(!expected.is_empty());
            let ends = [oracle.discrete(&q_t0).unwrap().to_vec(), oracle.discrete(&q_t1).unwrap().to_vec()];
            between += usize::from(expected.len() > ends.concat().len());
            for t in [0.0, 1.0, 0.5, 0.25, random.uniform(), random.uniform()] {
                let q: Vec<f64> = q_t0.iter().zip(&q_t1).map(|(a, b)| a * (1.0 - t) + b * t).collect();
                let Ok(now) = oracle.discrete(&q) else { continue };
                for pair in now {
                    let impact = expected.iter().find(|impact| impact.pair == *pair);
                    let time = impact.map(|impact| impact.time);
                    assert!(time.is_some_and(|time| time <= t), "model {seed}: {pair:?} {time:?} at {t}");
                    sampled += 1;
                }
            }
        }
    }
    let counts = (compared, hits, certified, sampled, between);
    assert!(
        compared > threshold(600)
            && hits > threshold(100)
            && certified > threshold(300)
            && sampled > threshold(5000)
            && between > threshold(15),
        "{counts:?}"
    );
}

/// Corners are on a coarse grid, and times are multiples of 1/8, so that all positions are exact.
#[test]
fn no_contact_of_grid_triangles_is_missed() {
    let random = &mut Random::new(12);
    let (mut met, mut free) = (0, 0);
    let cases = cases(100_000);
    for case in 0..cases {
        let size = [1.4, 2.4, 4.4][case % 3];
        let corners = |random: &mut Random| [(); 3].map(|()| (random.vector() * size).round());
        let mut moving = || {
            let t0 = corners(random);
            let mut t1 = corners(random);
            match case % 7 {
                0 => t1 = t0,
                1 => t1 = t0.map(|p| p + t1[0]),
                2 => t1.iter_mut().chain(&mut [DVec3::ZERO]).for_each(|p| p.z = 0.0),
                _ => {}
            }
            MovingTriangle { t0, t1 }
        };
        let (x, y) = (moving(), moving());
        let scale = random.power(-60.0, 55.0);
        let scale = 2.0_f64.powi(scale.log2().round() as i32);
        let scaled =
            |m: &MovingTriangle| MovingTriangle { t0: m.t0.map(|p| p * scale), t1: m.t1.map(|p| p * scale) };
        let impact = impact_triangle_triangle(&scaled(&x), &scaled(&y), 1e-9);
        let position = |m: &MovingTriangle, t: f64| -> [DVec3; 3] {
            std::array::from_fn(|i| m.t0[i] + (m.t1[i] - m.t0[i]) * t)
        };
        let meets = |t: &f64| sscc::intersect_triangle_triangle(&position(&x, *t), &position(&y, *t));
        let first = (0..=8).map(|i| f64::from(i) / 8.0).find(meets);
        if let Some(first) = first {
            assert!(impact.is_some_and(|t| t <= first), "{x:?} {y:?}: {impact:?}, met at {first}");
        }
        met += usize::from(first.is_some());
        free += usize::from(impact.is_none());
    }
    assert!(met > cases / 10 && free > cases / 10, "{met} {free}");
}

/// Returns two triangles at a distance of 1; the upper one is lowered by q.
fn lowered() -> ReducedModel {
    let triangle = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z);
    let mesh = TriMesh::new([triangle(0.0), triangle(1.0)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let entry = |row: usize, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
    ReducedModel::new(mesh, Modes::from_matrix(6, 1, entry).unwrap()).unwrap()
}

#[test]
fn times_of_simple_motions() {
    let model = lowered();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let near = |x: f64, goal: f64| x <= goal && x > goal - 1e-9;
    for method in [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce] {
        let mut query = Query::with_method(&model, &certificates, method).unwrap();
        // The triangles pass through each other; neither end collides.
        let impacts = query.continuous(&[0.0], &[4.0]).unwrap();
        assert_eq!(pairs(impacts), [(0, 1)]);
        assert!(near(impacts[0].time, 0.25), "{impacts:?}");
        assert_eq!(
            query.statistics().norm,
            sscc::parts::Scope::of_query(&query).metric.norm(&[4.0]).unwrap()
        );
        assert!(near(query.time_of_impact(&[3.0], &[-1.0]).unwrap().unwrap(), 0.5));
        // The triangles touch at an end, or during the whole motion.
        assert!(near(query.time_of_impact(&[0.0], &[1.0]).unwrap().unwrap(), 1.0));
        assert_eq!(query.time_of_impact(&[1.0], &[0.0]).unwrap(), Some(0.0));
        assert_eq!(query.time_of_impact(&[1.0], &[1.0]).unwrap(), Some(0.0));
        // The triangles move apart, or do not come near enough.
        assert_eq!(query.time_of_impact(&[0.999], &[-7.0]).unwrap(), None);
        assert_eq!(query.time_of_impact(&[0.0], &[1.0 - 1e-9]).unwrap(), None);
        assert_eq!(query.time_of_impact(&[0.5], &[0.5]).unwrap(), None);
        assert_eq!(query.statistics().root_certified, method == Method::Certified);
        assert!(matches!(query.continuous(&[f64::NAN], &[0.0]), Err(Error::CoordinatesValue { .. })));
        assert!(matches!(query.continuous(&[0.0], &[1e300]), Err(Error::CoordinatesRange)));
        assert!(query.continuous(&[0.0], &[]).is_err() && query.pairs().is_empty());
        // A discrete query does not change later continuous answers.
        assert_eq!(query.discrete(&[1.0]).unwrap(), [(0, 1)]);
        assert!(query.continuous(&[0.0], &[0.1]).unwrap().is_empty());
    }
    let mut plain = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
    assert_eq!(plain.continuous(&[0.0], &[4.0]).unwrap().len(), 1);
    let mut stopped = plain.cancelled_by(after(0));
    assert!(stopped.continuous(&[0.0], &[4.0]).is_ok()); // done before the first look
}
