//! Compares intervals of weights over which shapes collide with brute force at many weights. Also tests surroundings of pairs that
//! collide at rest.

use glam::DVec3;
use sscc::parts::{ProvenShares, Scope, penetration_triangle_triangle, surroundings_between_meshes};
use sscc::{
    CancelToken, Certificates, CertifyOptions, ContactFilter, Detector, Error, Method, ModeRange, Modes,
    Pair, Query, ReducedModel, SweepOutcome, TriMesh, WeightIntervals,
};
use sscc_testing::{cases, threshold};

use crate::common::{Random, random_model, random_options};

/// Checks that every weight outside of the intervals is free, that exact ends collide, and that samples are those of brute force.
fn check(
    found: &WeightIntervals,
    model: &ReducedModel,
    q: &[f64],
    oracle: &mut Query,
    weights: usize,
) -> usize {
    let ModeRange { mode, low, high } = found.range;
    let mut at = |w: f64| {
        let mut q = q.to_vec();
        q[mode] = w;
        let pairs = oracle.discrete(&q).unwrap().to_vec();
        let corners = |t: u32| model.mesh().faces()[t as usize].map(|v| model.position(v, &q));
        let depth = |(a, b): &Pair| {
            penetration_triangle_triangle(&corners(*a), &corners(*b)).map_or(0.0, |found| found.depth)
        };
        (pairs.len(), pairs.iter().map(depth).fold(0.0, f64::max))
    };
    assert_eq!((found.samples[0].weight, found.samples[found.samples.len() - 1].weight), (low, high));
    for sample in &found.samples {
        assert_eq!((sample.pairs, sample.depth), at(sample.weight), "{sample:?}");
    }
    let mut last = low;
    for interval in &found.intervals {
        assert!(last <= interval.free_until.unwrap_or(low) && interval.from <= interval.to, "{interval:?}");
        assert!(interval.free_until.is_none_or(|free| free <= interval.from), "{interval:?}");
        assert!(interval.free_from.is_none_or(|free| free >= interval.to), "{interval:?}");
        if interval.is_exact {
            for (w, free) in [(interval.from, interval.free_until), (interval.to, interval.free_from)] {
                assert!(at(w).0 > 0, "{w} {interval:?}");
                let nearest = (w.next_up() - w).max(1e-9 * (high - low));
                assert!(free.is_none_or(|free| (free - w).abs() <= nearest), "{w} {interval:?}");
            }
            let deepest = at(interval.deepest.weight);
            assert_eq!((interval.deepest.pairs, interval.deepest.depth), deepest, "{interval:?}");
        }
        last = interval.free_from.unwrap_or(high);
    }
    let mut hits = 0;
    for i in 0..weights {
        let w = (low + (high - low) * i as f64 / (weights - 1) as f64).min(high);
        let is_inside = found.intervals.iter().any(|interval| {
            interval.free_until.is_none_or(|free| w > free) && interval.free_from.is_none_or(|free| w < free)
        });
        let pairs = at(w).0;
        assert!(is_inside || pairs == 0, "{w} {found:?}");
        hits += usize::from(pairs > 0);
    }
    for sample in &found.samples {
        let is_listed = found.intervals.iter().any(|interval| {
            (interval.from..=interval.to).contains(&sample.weight) && interval.pairs >= sample.pairs
        });
        assert!(is_listed == (sample.pairs > 0) || !found.intervals.iter().all(|i| i.is_exact), "{found:?}");
    }
    hits
}

/// Returns a small triangle that a mode raises, and large ones at these heights.
fn plates(heights: &[f64]) -> ReducedModel {
    let small = [DVec3::ZERO, DVec3::X * 0.1, DVec3::new(0.0, 0.05, 0.25)];
    let plate = |z: f64| [[-4.0, -4.0], [4.0, -4.0], [0.0, 6.0]].map(|[x, y]| DVec3::new(x, y, z));
    let positions = [small.to_vec(), heights.iter().flat_map(|z| plate(*z)).collect()].concat();
    let faces = (0..positions.len() as u32 / 3).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
    let rise = (0..positions.len()).map(|v| if v < 3 { DVec3::Z } else { DVec3::ZERO }).collect();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(1, rise).unwrap()).unwrap()
}

#[test]
fn each_plate_is_an_interval_whatever_the_samples() {
    let model = plates(&[1.0, 2.0, 3.0]);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let query = Query::new(&model, &certificates).unwrap();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let find = |low: f64, high: f64, samples: usize| {
        let range = ModeRange { mode: 0, low, high };
        query.sweep_intervals(&[0.0], &[range], samples, None, &()).unwrap().remove(0)
    };
    for samples in [2, 3, 4, 5, 11, 41, 101] {
        let found = find(0.0, 4.0, samples);
        check(&found, &model, &[0.0], &mut oracle, 2000);
        let ends: Vec<f64> = found.intervals.iter().flat_map(|i| [i.from, i.to]).collect();
        // Plates without a free sample between them are one interval.
        let near = |x: f64| ends.iter().any(|end| (end - x).abs() < 1e-8);
        assert!(near(0.75) && near(3.0), "{ends:?}");
        assert!(samples <= 5 || [1.0, 1.75, 2.0, 2.75].into_iter().all(near), "{samples}: {ends:?}");
        assert!(found.intervals.iter().all(|i| i.is_exact && i.pairs >= 1 && i.pairs <= 3), "{found:?}");
    }
    // The ends of the range are inside of plates.
    let found = find(0.9, 2.9, 21);
    check(&found, &model, &[0.0], &mut oracle, 2000);
    let [first, .., last] = &found.intervals[..] else { panic!("{found:?}") };
    assert_eq!((found.intervals.len(), first.free_until, first.from), (3, None, 0.9));
    assert_eq!((last.free_from, last.to), (None, 2.9));
    // The deepest sample: half of the small triangle is above.
    assert!((0.1..0.2).contains(&found.intervals[1].deepest.depth), "{found:?}");
    // Ranges in which no weight or every weight collides, and a range of one weight.
    assert!(find(-3.0, 0.7, 9).intervals.is_empty());
    let all = find(1.5, 1.9, 2);
    assert!(matches!(all.intervals[..], [i] if i.free_from.is_none() && i.free_until.is_some()), "{all:?}");
    let inside = find(1.8, 1.9, 2).intervals;
    assert!(matches!(inside[..], [i] if i.free_from.is_none() && i.free_until.is_none()), "{inside:?}");
}

/// Two triangles are in one plane at a single weight, which no sample meets.
#[test]
fn a_contact_at_one_weight_is_an_interval() {
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let lowered = (0..6).map(|v| if v < 3 { DVec3::ZERO } else { DVec3::NEG_Z }).collect();
    let model = ReducedModel::new(mesh, Modes::new(1, lowered).unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let query = Query::new(&model, &certificates).unwrap();
    let range = ModeRange { mode: 0, low: 0.0, high: 3.1 };
    let found = query.sweep_intervals(&[0.0], &[range], 5, Some(1), &()).unwrap();
    let [interval] = found[0].intervals[..] else { panic!("{found:?}") };
    assert_eq!((interval.from, interval.to, interval.pairs, interval.deepest.depth), (1.0, 1.0, 1, 0.0));
    // Invalid options are errors.
    let find = |range: ModeRange, samples: usize| {
        query.sweep_intervals(&[0.0], &[range], samples, Some(1), &()).unwrap_err().to_string()
    };
    assert_eq!(find(range, 1), "the number of samples is 1: it must be from 2 to 2^20");
    assert!(find(range, usize::MAX).contains("it must be from 2 to 2^20"));
    assert!(find(ModeRange { high: 0.0, ..range }, 5).contains("is empty or not finite"));
    assert!(find(ModeRange { mode: 7, ..range }, 5).contains("there is no mode 7"));
}

/// Sweeps from both sides find collisions on the other side of the exact contact, because positions are rounded: the triangles are in
/// one plane at about 500 weights.
#[test]
fn an_interval_narrower_than_the_tolerance_has_ordered_ends() {
    let at = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z);
    let mesh = TriMesh::new([at(1000.0), at(1000.3)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let lowered = (0..6).map(|v| if v < 3 { DVec3::ZERO } else { DVec3::NEG_Z }).collect();
    let model = ReducedModel::new(mesh, Modes::new(1, lowered).unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let query = Query::new(&model, &certificates).unwrap();
    let range = ModeRange { mode: 0, low: 0.27, high: 0.33 };
    let found = query.sweep_intervals(&[0.27], &[range], 2, Some(1), &()).unwrap();
    let [interval] = &found[0].intervals[..] else { panic!("{found:?}") };
    assert!(interval.from < interval.to && interval.pairs == 1, "{interval:?}");
    let oracle = &mut Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
    check(&found[0], &model, &[0.27], oracle, 1000);
}

#[test]
fn brute_force_finds_nothing_outside_of_intervals() {
    let (mut found_intervals, mut hits, mut many) = (0, 0, 0);
    let weights = cases(10_000).max(500) as usize;
    for seed in 0..cases(100) {
        let model = random_model(seed + 70_000);
        let random = &mut Random::new(seed + 9_700_000);
        let options = random_options(seed, &model).epsilon(0.5);
        let Ok(certificates) = Certificates::compute(&model, &options, &crate::common::after(151)) else {
            continue;
        };
        let scope: &Scope = &certificates.parts().scope;
        let q = scope.center.clone();
        let query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        let mode = random.below(model.rank());
        let size = model.weight_limits()[mode] * random.power(-0.7, 0.5);
        let range = ModeRange { mode, low: q[mode] - size, high: q[mode] + size };
        let samples = [2, 3, 8, 33][random.below(4)];
        let Ok(found) = query.sweep_intervals(&q, &[range], samples, Some(1), &()) else { continue };
        hits += check(&found[0], &model, &q, &mut oracle, weights);
        found_intervals += found[0].intervals.len();
        many += usize::from(found[0].intervals.len() > 1);
    }
    assert!(
        found_intervals > threshold(30) as usize && hits > 1000 && many > threshold(4) as usize,
        "{found_intervals} {hits} {many}"
    );
}

/// Returns two squares of n x n cells of two triangles each, one above the other.
fn two_squares(n: u32) -> TriMesh {
    let vertex = |i: u32, j: u32, k: u32| (k * (n + 1) + j) * (n + 1) + i;
    let place = |v: u32| [v % (n + 1), v / (n + 1) % (n + 1), v / (n + 1) / (n + 1)].map(f64::from);
    let positions = (0..2 * (n + 1) * (n + 1)).map(|v| DVec3::from(place(v))).collect();
    let cells = (0..2 * n * n).map(|c| [c % n, c / n % n, c / n / n]);
    let faces = cells.flat_map(|[i, j, k]| {
        let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| vertex(i, j, k));
        [[a, b, c], [a, c, d]]
    });
    TriMesh::new(positions, faces.collect()).unwrap()
}

/// The surroundings of each pair are those that a plain search of rings finds.
#[test]
fn surroundings_are_those_of_all_triangles() {
    let mesh = two_squares(7);
    let faces = mesh.faces();
    let touch = |a: u32, b: u32| faces[a as usize].iter().any(|v| faces[b as usize].contains(v));
    let rings_around = |t: u32, rings: u32| {
        let mut around = vec![t];
        for _ in 0..rings {
            let next: Vec<u32> =
                (0..faces.len() as u32).filter(|b| around.iter().any(|a| touch(*a, *b))).collect();
            around = next;
        }
        around
    };
    let detector = Detector::new(&mesh);
    let half = faces.len() as u32 / 2;
    let given = [(0, half + 3), (7, half + 9), (40, half)];
    for rings in 0..4 {
        let mut expected: Vec<Pair> = Vec::new();
        for (a, b) in given {
            for a in rings_around(a, rings) {
                let others = rings_around(b, rings).into_iter().filter(|b| a != *b && !touch(a, *b));
                expected.extend(others.map(|b| (a.min(b), a.max(b))));
            }
        }
        expected.sort_unstable();
        expected.dedup();
        assert_eq!(detector.surroundings(&given, rings).unwrap(), expected, "{rings}");
    }
    let unknown = detector.surroundings(&[(0, 1), (3, 2 * half)], 1);
    assert_eq!(unknown, Err(Error::PairIndex { pair: 1, triangle: 2 * half, triangles: 2 * half as usize }));
}

/// Between two meshes every pair counts: the surroundings of a pair are all pairs of a triangle around its first one and a triangle
/// around its second one.
#[test]
fn surroundings_between_meshes_are_those_of_all_triangles() {
    let (mesh, other) = (two_squares(5), two_squares(3));
    let rings_around = |mesh: &TriMesh, t: u32, rings: u32| {
        let faces = mesh.faces();
        let touch = |a: u32, b: u32| faces[a as usize].iter().any(|v| faces[b as usize].contains(v));
        (0..rings).fold(vec![t], |around, _| {
            (0..faces.len() as u32).filter(|b| around.iter().any(|a| touch(*a, *b))).collect()
        })
    };
    let detectors = [&mesh, &other].map(Detector::new);
    let given = [(7, 2), (0, 9), (7, 2)];
    for rings in 0..3 {
        let mut expected: Vec<Pair> = Vec::new();
        for (a, b) in given {
            let others = rings_around(&other, b, rings);
            let all = rings_around(&mesh, a, rings);
            expected.extend(all.iter().flat_map(|a| others.iter().map(move |b| (*a, *b))));
        }
        expected.sort_unstable();
        expected.dedup();
        let found = surroundings_between_meshes(detectors.each_ref(), &given, rings).unwrap();
        assert_eq!(found, expected, "{rings}");
    }
    let triangles = other.faces().len();
    let unknown = surroundings_between_meshes(detectors.each_ref(), &[(0, 0), (0, triangles as u32)], 0);
    assert_eq!(unknown, Err(Error::PairIndex { pair: 1, triangle: triangles as u32, triangles }));
    let token = CancelToken::new();
    token.cancel();
    let [a, b] = detectors.map(|detector| detector.cancelled_by(token.clone()));
    assert_eq!(surroundings_between_meshes([&a, &b], &given, 1), Err(Error::Cancelled));
    assert_eq!(a.surroundings(&given, 1), Err(Error::Cancelled));
}

/// A single mode reports its samples, and the last report is that of the end.
#[test]
fn intervals_of_one_mode_report_progress() {
    struct Reports(std::sync::Mutex<Vec<(usize, usize)>>);
    impl sscc::Progress for Reports {
        fn report(&self, done: usize, total: usize) {
            self.0.lock().unwrap().push((done, total));
        }
    }
    let mesh = two_squares(2);
    let vertices = mesh.rest_positions().len();
    let modes = (0..vertices).map(|v| if 2 * v < vertices { DVec3::ZERO } else { DVec3::Z }).collect();
    let model = ReducedModel::new(mesh, sscc::Modes::new(1, modes).unwrap()).unwrap();
    let query = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
    for samples in [2, 10, 1000] {
        let reports = Reports(std::sync::Mutex::default());
        let range = ModeRange { mode: 0, low: 0.0, high: 1.0 };
        query.sweep_intervals(&[0.0], &[range], samples, Some(1), &reports).unwrap();
        let reports = reports.0.into_inner().unwrap();
        assert!(reports.len() > samples.min(50), "{reports:?}");
        assert!(reports.is_sorted() && reports.last() == Some(&(64, 64)), "{reports:?}");
    }
}

/// The neighbours of triangles that touch at rest touch at small weights.
#[test]
fn surroundings_of_rest_collisions_are_ignored() {
    // One corner of the upper square is on the lower one.
    let squares = two_squares(4);
    let upper = squares.faces().len() as u32 / 2;
    let positions: Vec<DVec3> = squares
        .rest_positions()
        .iter()
        .map(|x| {
            if x.z > 0.0 && *x != DVec3::new(1.0, 1.0, 1.0) {
                x + DVec3::Z
            } else {
                DVec3::new(x.x + 0.25 * x.z, x.y, 0.0)
            }
        })
        .collect();
    // A mode moves the upper square sideways and down.
    let vertices = positions.len();
    let modes =
        (0..vertices).map(|v| if 2 * v < vertices { DVec3::ZERO } else { DVec3::new(1.6, 1.3, -0.2) });
    let modes = modes.collect();
    let mesh = TriMesh::new(positions, squares.faces().to_vec()).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
    let detector = Detector::new(model.mesh());
    let at_rest = Detector::new(model.mesh()).discrete(model.mesh().rest_positions()).unwrap().to_vec();
    assert!(!at_rest.is_empty() && at_rest.iter().all(|(a, b)| *a < upper && *b >= upper));
    let mut left = Vec::new();
    for rings in [0, 1, 2, 20] {
        let options = CertifyOptions::default().ignore_rest(rings);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let ignored = detector.surroundings(&at_rest, rings).unwrap();
        assert_eq!(certificates.filter().ignored(), ignored);
        let filter = ContactFilter::default().ignoring_rest(&model, rings).unwrap();
        assert_eq!(certificates.filter(), &filter);
        let mut query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
        let mut expected = oracle.discrete(&[1.0]).unwrap().to_vec();
        expected.retain(|pair| ignored.binary_search(pair).is_err());
        assert_eq!(query.discrete(&[1.0]).unwrap(), expected);
        left.push(expected.len());
    }
    assert!(left[0] > left[1] && left[1] >= left[2] && left[3] == 0, "{left:?}");
}

/// Two parallel triangles, apart by one unit in the last place, slide along each other.
#[test]
fn a_grazing_contact_is_no_collision() {
    let p = [0.0, 2.0_f64.powi(-40)].map(|gap| {
        [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]]
            .map(|[x, y, z]| DVec3::new(x, y, 4096.0 + z + gap))
    });
    let mesh = TriMesh::new(p.concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = (0..6).map(|v| if v < 3 { DVec3::ZERO } else { DVec3::Y }).collect();
    let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::BdTree).unwrap();
    let outcome = query.sweep(&[0.0], 0, 0.5).unwrap().outcome;
    assert_eq!(outcome, SweepOutcome::WithinTolerance);
    let range = ModeRange { mode: 0, low: 0.0, high: 0.5 };
    let found = query.sweep_intervals(&[0.0], &[range], 2, Some(1), &()).unwrap();
    assert!(!found[0].intervals.is_empty());
    assert!(found[0].intervals.iter().all(|i| i.pairs == 0 && !i.is_exact), "{found:?}");
    assert!(query.sweep_modes(&[0.0], &[], None, &()).unwrap().is_empty());
}

#[test]
fn a_pair_that_collides_at_the_centre_is_counted_and_not_proven() {
    let crossing = [[0.25, 0.25, -0.5], [0.25, 0.375, 0.5], [0.375, 0.25, 0.5]].map(DVec3::from);
    let p = [[DVec3::ZERO, DVec3::X, DVec3::Y], crossing].concat();
    let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = (0..6).map(|v| if v < 3 { DVec3::ZERO } else { DVec3::Z }).collect();
    let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
    let options = CertifyOptions::default().max_exceptions(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    // |z| and the radius are 0.
    assert_eq!(query.count(&[0.0]).unwrap(), 1);
    assert_eq!(ProvenShares::of(&mut query, &[0.0]).unwrap().search, 1.0);
}
