//! Batches have the same answers and the same statistics as single queries, for any number of q.

use glam::DVec3;
use sscc::{Answer, Certificates, Error, Method, Modes, Query, ReducedModel, TriMesh};
use sscc_testing::cases;

use crate::common::{Random, at, random_model, random_options, winding_strip};

const METHODS: [Method; 5] =
    [Method::Certified, Method::BdTree, Method::Traditional, Method::NormalCones, Method::BruteForce];

/// Returns a rolled-up sheet of many buckets, whose vertices all move by random amounts. `unit`: its size.
fn sheet(random: &mut Random, rank: usize, unit: f64) -> ReducedModel {
    let side = 20 + random.below(6) as u32;
    let positions: Vec<DVec3> = (0..side * side)
        .map(|i| {
            let (s, t) = (f64::from(i / side), f64::from(i % side));
            let angle = 0.5 * s;
            DVec3::new((1.0 + 0.2 * s) * angle.cos(), (1.0 + 0.2 * s) * angle.sin(), 0.5 * t) * unit
        })
        .collect();
    let corner = |i: u32, j: u32| i * side + j;
    let faces = (0..side - 1).flat_map(|i| (0..side - 1).map(move |j| (i, j))).flat_map(|(i, j)| {
        let square = [corner(i, j), corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1)];
        [[square[0], square[1], square[2]], [square[1], square[3], square[2]]]
    });
    let faces = faces.collect();
    let directions: Vec<[DVec3; 2]> = (0..rank).map(|_| [random.vector(), random.vector()]).collect();
    let noise = random.power(-4.0, -1.0);
    let mut rows = Vec::new();
    for x in &positions {
        for [dir, along] in &directions {
            rows.push((*dir * (x.dot(*along) / unit).sin() + random.vector() * noise) * unit);
        }
    }
    let mesh = TriMesh::new(positions, faces).unwrap();
    ReducedModel::new(mesh, Modes::new(rank, rows).unwrap()).unwrap()
}

/// Returns the answers of single queries; `None` for a q that is refused.
fn one_by_one(query: &mut Query, batch: &[Vec<f64>], limit: usize) -> Vec<Option<Answer>> {
    let answer = |q: &Vec<f64>| {
        let pairs = query.discrete_at_most(q, limit).ok()?.to_vec();
        Some(Answer { pairs, statistics: query.statistics() })
    };
    batch.iter().map(answer).collect()
}

/// Compares batches with single queries. Returns the numbers of answers with pairs, of free ones, and of those that the root
/// certifies.
fn compare(name: &str, certificates: &Certificates, model: &ReducedModel, random: &mut Random) -> [usize; 3] {
    let scope = &certificates.parts().scope;
    let root = certificates.root_radius();
    let unit = if root > 0.0 && root.is_finite() { root } else { 1.0 };
    let batch: Vec<Vec<f64>> = (0..14)
        .map(|i| {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed()).collect();
            let size = match i % 6 {
                0 => unit * random.power(-3.0, 0.0),
                1 | 2 => unit * random.power(0.0, 1.0),
                3 | 4 => unit * random.power(0.5, 2.0),
                _ => unit * random.power(-3.0, 3.0),
            };
            at(scope, &z.iter().map(|z| z * size).collect::<Vec<f64>>())
        })
        .filter(|q| model.check_coordinates(q).is_ok())
        .collect();
    let mut counts = [0; 3];
    // Large models are tested with the two methods that compute boxes when they visit nodes.
    let methods = if model.mesh().faces().len() < 300 { &METHODS[..] } else { &METHODS[..2] };
    for &method in methods {
        let mut query = Query::with_method(model, certificates, method).unwrap();
        for limit in [usize::MAX, 1 + random.below(4)] {
            let expected: Vec<Answer> =
                one_by_one(&mut query, &batch, limit).into_iter().map(Option::unwrap).collect();
            for answer in &expected {
                counts[0] += usize::from(!answer.pairs.is_empty());
                counts[1] += usize::from(answer.pairs.is_empty());
                counts[2] += usize::from(answer.statistics.root_certified);
            }
            for threads in [Some(1), Some(2)] {
                let found = query.batch_at_most(&batch, limit, threads, &()).unwrap();
                assert_eq!(found, expected, "{name}, {method:?}, limit {limit}, threads {threads:?}");
            }
            // In two parts the batch is divided into other groups.
            let (first, second) = batch.split_at(random.below(batch.len() + 1));
            let parts = [first, second].map(|part| query.batch_at_most(part, limit, Some(1), &()).unwrap());
            assert_eq!(parts.concat(), expected, "{name}, {method:?}, {} and the rest", first.len());
        }
    }
    counts
}

#[test]
fn answers_are_those_of_single_queries() {
    let mut counts = [0; 3];
    let (mut skipped, seeds) = (0, cases(40_u64));
    for seed in 0..seeds {
        let random = &mut Random::new(seed + 9_000_000);
        let model = match seed % 3 {
            // Some models have units in which coarse positions are not available.
            0 => {
                let unit = [1.0, 1e-12, 1e-200, 1e50][seed as usize / 3 % 4];
                sheet(random, [1, 3, 30][seed as usize / 3 % 3], unit)
            }
            1 => winding_strip(random, seed),
            _ => random_model(seed + 9_000_000),
        };
        let options = random_options(seed, &model);
        let Ok(certificates) = Certificates::compute(&model, &options, &()) else {
            skipped += 1;
            continue;
        };
        let of_model = compare(&format!("model {seed}"), &certificates, &model, random);
        counts.iter_mut().zip(of_model).for_each(|(all, count)| *all += count);
    }
    let least = 5 * seeds as usize;
    assert!(skipped < 1 + seeds / 4 && counts.iter().all(|count| *count > least), "{skipped} {counts:?}");
}

/// The error is that of the first q that has one, for any number of threads.
#[test]
fn the_first_error_is_reported() {
    let random = &mut Random::new(77);
    let model = sheet(random, 3, 1.0);
    let certificates = Certificates::compute(&model, &random_options(1, &model), &()).unwrap();
    let query = Query::new(&model, &certificates).unwrap();
    let good: Vec<Vec<f64>> = (0..40).map(|_| (0..3).map(|_| random.signed()).collect()).collect();
    let bad = [vec![0.0; 2], vec![f64::NAN, 0.0, 0.0], vec![0.0, 1e300, 0.0]];
    let error = |q: &[f64]| query.clone().discrete(q).unwrap_err();
    for _ in 0..60 {
        let mut batch = good[..1 + random.below(40)].to_vec();
        let [i, j] = [(); 2].map(|()| random.below(batch.len()));
        batch[i] = bad[random.below(3)].clone();
        batch[j] = bad[random.below(3)].clone();
        let expected: Error = error(&batch[i.min(j)]);
        for threads in [1, 2] {
            // NaN differs from itself.
            let found = query.batch(&batch, Some(threads), &()).unwrap_err();
            assert_eq!(found.to_string(), expected.to_string());
        }
    }
    let none: [&[f64]; 0] = [];
    assert_eq!(query.batch(&none, None, &()), Ok(vec![]));
}

/// Every report has the number of answers so far, and the last one is that of the end.
#[test]
fn batches_report_the_number_of_answers() {
    struct Reports(std::sync::Mutex<Vec<(usize, usize)>>);
    impl sscc::Progress for Reports {
        fn report(&self, done: usize, total: usize) {
            self.0.lock().unwrap().push((done, total));
        }
    }
    // A triangle one unit above another one, which the mode lifts.
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    let modes = (0..6).map(|v| if v < 3 { DVec3::ZERO } else { DVec3::Z }).collect();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &sscc::CertifyOptions::default(), &()).unwrap();
    let query = Query::new(&model, &certificates).unwrap();
    // The root's certificate proves all free but the last three.
    let batch: Vec<[f64; 1]> = (0..133).map(|i| if i < 130 { [0.0] } else { [-1.0] }).collect();
    let reports = Reports(std::sync::Mutex::default());
    let answers = query.batch(&batch, Some(1), &reports).unwrap();
    assert!(answers[129].statistics.root_certified && answers[130].pairs == [(0, 1)]);
    let reports = reports.0.into_inner().unwrap();
    assert!(reports.is_sorted() && reports.ends_with(&[(131, 133), (132, 133), (133, 133), (133, 133)]));
    assert!(reports.iter().rev().skip(4).all(|(done, _)| *done <= 130), "{reports:?}");
    // A batch that fails does not report its end.
    let reports = Reports(std::sync::Mutex::default());
    assert!(query.batch(&[[0.0], [f64::NAN]], Some(1), &reports).is_err());
    assert!(reports.0.into_inner().unwrap().is_empty());
}
