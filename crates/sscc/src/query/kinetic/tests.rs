//! Compares kinetic queries with regions of all sizes with brute force.

use glam::DVec3;
use sscc_testing::{cases, threshold};

use super::kinetic_query::KineticQuery;
use crate::test_models::Random;
use crate::{
    Certificates, CertifyOptions, ContactFilter, Impact, Method, Metric, MetricKind, Modes, Neighbours,
    Query, ReducedModel, Statistics, TriMesh,
};

/// Returns two wavy sheets one above the other, in every second case joined by a third one between them; modes bring them
/// together, tilt, bend and shear them.
fn sheets(random: &mut Random, case: usize) -> ReducedModel {
    let side = 6 + case as u32 % 5;
    let gap = 0.3 + 0.3 * random.signed().abs();
    let mut p = Vec::new();
    let mut faces = Vec::new();
    for sheet in 0..2 + case as u32 % 2 {
        let first = p.len() as u32;
        for i in 0..side * side {
            let x = DVec3::new(f64::from(i % side), f64::from(i / side), f64::from(sheet) * gap);
            p.push(x * DVec3::new(0.2, 0.2, 1.0) + random.vector() * 0.03);
        }
        for i in (0..side * (side - 1)).filter(|i| i % side != side - 1) {
            let [a, b, c, d] = [i, i + 1, i + side, i + side + 1].map(|v| first + v);
            faces.extend([[a, b, d], [a, d, c]]);
        }
    }
    let rank = 2 + case % 4;
    let ways: Vec<[DVec3; 2]> = (0..rank).map(|_| [random.vector(), random.vector() * 2.0]).collect();
    let modes = p.iter().flat_map(|x| {
        let (height, x) = (x.z / gap, *x);
        ways.iter().enumerate().map(move |(k, [way, along])| match k {
            0 => DVec3::Z * (0.5 - height) * 0.3,
            _ => (*way * 0.1 + DVec3::Z * (x.dot(*along)).sin()) * 0.3 * (0.2 + height),
        })
    });
    let modes = Modes::new(rank, modes.collect()).unwrap();
    let mesh = TriMesh::new(p, faces).unwrap();
    let metric = match case % 3 {
        0 => Metric::displacement(&mesh, &modes).unwrap(),
        1 => Metric::identity(rank),
        _ => {
            let mut entry = |i: usize, j: usize| match i.cmp(&j) {
                std::cmp::Ordering::Less => 0.5 * random.signed(),
                std::cmp::Ordering::Equal => 1.0 + random.signed().abs(),
                std::cmp::Ordering::Greater => 0.0,
            };
            let factor = (0..rank * rank).map(|e| entry(e / rank, e % rank)).collect();
            Metric::from_factor(MetricKind::Given, rank, factor).unwrap()
        }
    };
    ReducedModel::with_metric(mesh, modes, metric).unwrap()
}

/// Counts of the cases of kinetic queries.
#[derive(Debug, Default)]
struct Seen {
    steps: usize,
    balls: usize,
    capsules: usize,
    known: usize,
    expired: usize,
    /// Pairs that began to collide in a step without a search.
    begun: usize,
    root_certified_within: usize,
    /// Motions that a region proved free, and those that searches found free.
    proven: usize,
    known_free: usize,
    aimed: usize,
}

/// A kinetic query with regions of all sizes, and a query by brute force.
struct Pairing<'a> {
    kinetic: KineticQuery,
    oracle: Query,
    certificates: &'a Certificates,
    colliding: bool,
    /// Whether regions are disabled.
    plain: bool,
    /// The last q.
    before: Vec<f64>,
}

impl Pairing<'_> {
    fn ask(&mut self, z: &[f64], random: &mut Random, seen: &mut Seen) {
        let scope = &self.certificates.parts().scope;
        let q: Vec<f64> = scope.metric.unscale(z).iter().zip(&scope.center).map(|(d, c)| c + d).collect();
        for sizes in [&mut self.kinetic.control.balls, &mut self.kinetic.control.capsules] {
            sizes.pause = u64::from(self.plain || random.signed() > 0.98) * 3;
            sizes.share = 10.0_f64.powf(random.signed() * 1.7 - 2.3);
        }
        self.kinetic.control.plain_cost = self.kinetic.control.plain_cost.max(1_000_000);
        // The motion to this q, before the discrete query at its end.
        if !self.before.is_empty() && random.signed() > 0.5 {
            let pairs = |impacts: &[Impact]| impacts.iter().map(|impact| impact.pair).collect::<Vec<_>>();
            let found = pairs(self.kinetic.continuous(&self.before, &q).unwrap());
            assert_eq!(found, self.kinetic.pairs());
            assert_eq!(found, pairs(self.oracle.continuous(&self.before, &q).unwrap()));
            assert_eq!(self.kinetic.statistics().norm, self.oracle.norm());
            let Statistics { root_certified, complete, .. } = self.kinetic.statistics();
            assert!(complete);
            seen.known_free += usize::from(self.kinetic.free_q == q);
            seen.proven += usize::from(found.is_empty() && !root_certified && self.kinetic.free_q.is_empty());
        }
        self.before.clone_from(&q);
        let stood = self.kinetic.region_pairs.has_region();
        let apart = self.kinetic.region_pairs.safe.len();
        let expected = self.oracle.discrete(&q).unwrap();
        let found = self.kinetic.discrete(&q).unwrap();
        assert_eq!(found, expected);
        let begins = !self.colliding && !found.is_empty();
        self.colliding = !found.is_empty();
        let region_pairs = &self.kinetic.region_pairs;
        seen.steps += 1;
        seen.root_certified_within += usize::from(stood && self.kinetic.statistics().root_certified);
        if region_pairs.steps == 1 && region_pairs.has_region() {
            let is_capsule = self.kinetic.region.size() > self.kinetic.region.radius;
            *(if is_capsule { &mut seen.capsules } else { &mut seen.balls }) += 1;
            seen.known += region_pairs.remembered.len();
        } else if stood && region_pairs.has_region() {
            seen.expired += apart.saturating_sub(region_pairs.safe.len());
            seen.begun += usize::from(begins);
        }
    }
}

/// q moves through the first contact and back in steps of all sizes, and towards pairs within their safe distance, with jumps,
/// returns, errors, and queries that the root's certificate answers.
#[test]
fn answers_are_those_of_plain_queries_whatever_regions_there_are() {
    let mut seen = Seen::default();
    for case in 0..cases(60) {
        let random = &mut Random(case as u64 + 1000);
        let model = sheets(random, case);
        let rank = model.rank();
        let neighbours = [Neighbours::Exclude, Neighbours::IncludeOneVertex][usize::from(case % 4 == 3)];
        let center: Vec<f64> =
            (0..rank).map(|_| if case % 5 == 2 { 0.02 * random.signed() } else { 0.0 }).collect();
        let options = CertifyOptions::default()
            .epsilon(0.5)
            .center(center)
            .filter(ContactFilter::new(neighbours).weld(case % 7 == 1))
            .budget([0, 8, 256][case % 3]);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut pairing = Pairing {
            kinetic: KineticQuery::new(&model, &certificates).unwrap(),
            oracle: Query::with_method(&model, &certificates, Method::BruteForce).unwrap(),
            certificates: &certificates,
            colliding: false,
            plain: false,
            before: Vec::new(),
        };
        for _ in 0..3 {
            let mut way: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
            if random.signed() > 0.0 {
                way = (0..rank).map(|k| if k == 0 { 1.0 } else { 0.2 * random.signed() }).collect();
            }
            let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
            let at = |t: f64| -> Vec<f64> { way.iter().map(|x| x / length * t).collect() };
            // Finds the first contact.
            let scope = &certificates.parts().scope;
            let collides = |query: &mut Query, t: f64| {
                let d = scope.metric.unscale(&at(t));
                let q: Vec<f64> = d.iter().zip(&scope.center).map(|(d, c)| c + d).collect();
                !query.discrete(&q).unwrap().is_empty()
            };
            let root = certificates.root_radius().max(1e-3);
            let (mut free, mut t) = (0.0, root);
            while t < 100.0 * root && !collides(&mut pairing.oracle, t) {
                (free, t) = (t, 1.2 * t);
            }
            for _ in 0..20 {
                let middle = 0.5 * (free + t);
                if collides(&mut pairing.oracle, middle) { t = middle } else { free = middle }
            }
            let stride = 10.0_f64.powf(random.signed() * 0.8 - 3.2);
            // The motion is straight, bent, or noisy.
            let noise = if random.signed() > 0.3 { 0.1 * stride * t } else { 0.0 };
            let bow: Vec<f64> = (0..rank).map(|_| random.signed().max(0.0) * 30.0 * t).collect();
            let count = ((0.06 / stride) as usize).min(150);
            for i in (0..count).chain((0..count).rev()) {
                let share = 1.0 + (i as f64 - 0.5 * count as f64) * stride;
                let bent = at(share * t).into_iter().zip(&bow).map(|(z, b)| z + b * (share - 1.0).powi(2));
                let z: Vec<f64> = bent.map(|z| z + noise * random.signed()).collect();
                pairing.ask(&z, random, &mut seen);
                if random.signed() > 0.98 {
                    let wrong = [f64::NAN];
                    let is_refused = match random.signed() > 0.0 {
                        true => pairing.kinetic.discrete(&wrong).is_err(),
                        false => pairing.kinetic.continuous(&pairing.before, &wrong).is_err(),
                    };
                    assert!(is_refused);
                    assert_eq!(pairing.kinetic.pairs(), []);
                    let statistics = pairing.kinetic.statistics();
                    assert_eq!(statistics, Statistics { norm: statistics.norm, ..Statistics::default() });
                }
                // A step to a z that the root's certificate proves free.
                if random.signed() > 0.97 {
                    pairing.ask(&at(0.999 * certificates.root_radius() * random.signed()), random, &mut seen);
                }
                // Steps towards a collision of a pair within its safe distance.
                let Some(standing) = pairing.kinetic.region_pairs.safe.peek().copied() else { continue };
                if random.signed() < 0.8 {
                    continue;
                }
                seen.aimed += 1;
                let margin = standing.key - pairing.kinetic.region_pairs.travelled;
                let [a, b] = [standing.order.0, standing.order.1]
                    .map(|f| model.mesh().faces()[f as usize][(random.signed().abs() * 3.0) as usize % 3]);
                let q: Vec<f64> =
                    scope.metric.unscale(&z).iter().zip(&scope.center).map(|(d, c)| c + d).collect();
                let d = model.position(b, &q) - model.position(a, &q);
                let rows = [a, b].map(|v| {
                    let mut rows = vec![DVec3::ZERO; rank];
                    scope.metric.scaled_modes(model.modes().of_vertex(v), &mut rows);
                    rows
                });
                let towards: Vec<f64> = (0..rank).map(|k| -d.dot(rows[1][k] - rows[0][k])).collect();
                let length = towards.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-300);
                for share in [0.5, 0.9, 1.0, 1.1, 1.5] {
                    let there: Vec<f64> =
                        z.iter().zip(&towards).map(|(z, x)| z + x / length * margin * share).collect();
                    pairing.ask(&there, random, &mut seen);
                }
            }
            // Plain queries follow z, in steps too small for a jump, to collisions of pairs that had safe distances.
            for share in [0.95, 1.1, 1.25] {
                pairing.plain = share > 1.0;
                pairing.ask(&at(share * t), random, &mut seen);
                pairing.ask(&at((share + 1e-5) * t), random, &mut seen);
            }
            pairing.plain = false;
            for i in 1..5 {
                pairing.ask(&at((1.25 + f64::from(i) * 1e-4) * t), random, &mut seen);
            }
            // A jump to collisions of pairs that were separate before.
            for i in 0..10 {
                pairing.ask(&at((1.3 + f64::from(i) * 1e-4) * t), random, &mut seen);
            }
        }
    }
    assert!(
        seen.balls > threshold(300)
            && seen.capsules > threshold(100)
            && seen.known > threshold(1000)
            && seen.expired > threshold(1000)
            && seen.aimed > threshold(100),
        "{seen:?}"
    );
    assert!(
        seen.begun > threshold(50)
            && seen.proven > threshold(500)
            && seen.known_free > threshold(300)
            && seen.root_certified_within > threshold(50),
        "{seen:?}"
    );
}

/// Returns a sheet of triangles over a square, at a height; every second row is higher by `fold`.
fn sheet(side: u32, height: f64, fold: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let row = |i: u32| i / (side + 1);
    let at = |i: u32| {
        DVec3::new(f64::from(i % (side + 1)), f64::from(row(i)), height + fold * f64::from(row(i) % 2))
    };
    let p = (0..(side + 1) * (side + 1)).map(at).collect();
    let square = |i: u32| {
        let a = i / side * (side + 1) + i % side;
        [[a, a + 1, a + side + 2], [a, a + side + 2, a + side + 1]]
    };
    (p, (0..side * side).flat_map(square).collect())
}

/// Returns three sheets of `side` squares one above the other, and optionally two separate triangles that intersect at rest. Modes
/// raise the lower sheet, lower the upper one, and move both sideways, so that the radii of pairs of nodes are those of contact,
/// nearly to the last digit.
fn three_sheets(side: u32, heights: [f64; 3], intersects_at_rest: bool) -> ReducedModel {
    let (mut p, mut faces) = (Vec::new(), Vec::new());
    for (height, fold) in heights.into_iter().zip([-0.5, 0.0, 0.5]) {
        let (more, squares) = sheet(side, height, fold);
        faces.extend(squares.into_iter().map(|face| face.map(|v| v + p.len() as u32)));
        p.extend(more);
    }
    let each = p.len() / 3;
    let aside = DVec3::new(1e-3, 2e-3, 0.0);
    let mut modes: Vec<DVec3> = (0..p.len())
        .flat_map(|v| match v / each {
            0 => [DVec3::Z, DVec3::ZERO, aside],
            1 => [DVec3::ZERO; 3],
            _ => [DVec3::ZERO, DVec3::NEG_Z, aside],
        })
        .collect();
    if intersects_at_rest {
        let first = p.len() as u32;
        faces.extend([[first, first + 1, first + 2], [first + 3, first + 4, first + 5]]);
        let corners = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, -1], [1, 1, 1], [1, 1, -1]];
        p.extend(corners.map(|x| DVec3::from_array(x.map(f64::from)) - DVec3::X * 50.0));
        modes.extend([DVec3::ZERO; 18]);
    }
    let modes = Modes::new(3, modes).unwrap();
    ReducedModel::with_metric(TriMesh::new(p, faces).unwrap(), modes, Metric::identity(3)).unwrap()
}

/// Computes certificates with a small error.
fn tight_certificates(model: &ReducedModel, budget: usize) -> Certificates {
    let options = CertifyOptions::default().budget(budget).epsilon(0.01);
    Certificates::compute(model, &options, &()).unwrap()
}

/// q moves to a contact of the middle sheet with one of the others, beyond the root's radius, straight or in a zigzag, in steps so
/// small that regions begin before a radius and end beyond it. Each sheet has several buckets or one.
#[test]
fn radii_are_crossed_inside_a_region() {
    let mut crossed = [0, 0];
    for case in 0..cases(24) {
        let random = &mut Random(case as u64 + 700_000);
        let mut uniform = || 0.5 + 0.5 * random.signed();
        let heights = [-1.0 - uniform(), 0.0, 2.5 + uniform()];
        let model = three_sheets([10, 8, 5][case % 3], heights, false);
        let certificates = tight_certificates(&model, [0, 1 << 10][case / 3 % 2]);
        // The lower sheets meet at the root's radius, the upper ones at this.
        let contact = heights[2];
        assert!(certificates.root_radius() < 0.9 * contact);
        let stride = contact * 10.0_f64.powf(-3.0 - uniform());
        let begin = contact - stride * (10.0 + 20.0 * uniform());
        for (zigzag, crossed) in [0.0, 1.0].into_iter().zip(&mut crossed) {
            let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
            let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
            let (mut colliding, mut first) = (0, false);
            for i in 0..60 {
                kinetic.control.plain_cost = 1_000_000;
                let q = [0.0, begin + stride * f64::from(i), zigzag * stride * f64::from(i % 2)];
                let expected = oracle.discrete(&q).unwrap();
                assert_eq!(kinetic.discrete(&q).unwrap(), expected);
                // The first pairs are found in a region that began before the radius.
                first |= colliding == 0 && !expected.is_empty() && kinetic.region_pairs.steps > 1;
                colliding += usize::from(!expected.is_empty());
            }
            assert!((20..55).contains(&colliding));
            *crossed += usize::from(first);
        }
    }
    assert!(crossed.iter().all(|crossed| *crossed > threshold(16)), "{crossed:?}");
}

/// z moves along a capsule, away from any contact, and then leaves it sideways to a contact of sheets that the search of the
/// capsule did not find. The step is shorter than the capsule. Answers of both kinds of queries are those of brute force, also with
/// exceptions, which no region contains.
#[test]
fn capsules_are_left_sideways() {
    let mut left = 0;
    for case in 0..cases(24) {
        let random = &mut Random(case as u64 + 800_000);
        let heights = [-1.2, 0.0, 2.5 + 0.5 * random.signed()];
        let model = three_sheets([10, 5, 4][case % 3], heights, case % 4 == 3);
        let certificates = tight_certificates(&model, [0, 1 << 10][case / 3 % 2]);
        let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let contact = heights[2];
        let gap = contact * 0.05;
        let along = |i: i32| [0.0, contact - gap, contact * 0.01 * f64::from(i)];
        let mut last = along(-8);
        for i in -8..8 {
            kinetic.control.plain_cost = 1_000_000;
            kinetic.control.capsules.share = 0.5;
            let q = along(i);
            let expected = oracle.continuous(&last, &q).unwrap().to_vec();
            assert_eq!(kinetic.continuous(&last, &q).unwrap(), expected);
            assert_eq!(kinetic.discrete(&q).unwrap(), oracle.discrete(&q).unwrap());
            last = q;
        }
        let is_capsule = kinetic.region_pairs.steps > 1
            && kinetic.region.size() > 2.0 * gap
            && kinetic.region.radius < 0.9 * gap;
        left += usize::from(is_capsule);
        let aside = [0.0, contact + 0.01 * gap, last[2]];
        let expected = oracle.continuous(&last, &aside).unwrap().to_vec();
        assert_eq!(kinetic.continuous(&last, &aside).unwrap(), expected, "case {case}");
        assert!(!oracle.discrete(&aside).unwrap().is_empty());
        assert_eq!(kinetic.discrete(&aside).unwrap(), oracle.discrete(&aside).unwrap(), "case {case}");
    }
    assert!(left > threshold(20), "{left}");
}

/// A motion ends at the last q, or elsewhere in its region, and begins at another q: at a contact of sheets, or
/// beyond other pairs than those of the region.
#[test]
fn motions_may_begin_anywhere() {
    let (mut within, mut colliding) = (0, 0);
    for case in 0..cases(24) {
        let random = &mut Random(case as u64 + 900_000);
        let heights = [-1.2, 0.0, 2.5 + 0.5 * random.signed()];
        let model = three_sheets([10, 5, 4][case % 3], heights, false);
        let certificates = tight_certificates(&model, [0, 1 << 10][case / 3 % 2]);
        let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let contact = heights[2];
        let gap = contact * 0.05;
        for i in -8..8 {
            kinetic.control.plain_cost = 1_000_000;
            kinetic.control.capsules.share = 0.5;
            let q = [0.0, contact - gap, contact * 0.01 * f64::from(i)];
            assert_eq!(kinetic.discrete(&q).unwrap(), oracle.discrete(&q).unwrap());
            let pairs = |impacts: &[Impact]| impacts.iter().map(|impact| impact.pair).collect::<Vec<_>>();
            for aside in [1.01, 1.2, 0.5, -0.5] {
                let start = [0.0, contact - gap + aside * gap, q[2] + contact * 0.01 * random.signed()];
                for end in [q, [0.0, q[1], q[2] - contact * 0.005]] {
                    let expected = pairs(oracle.continuous(&start, &end).unwrap());
                    let is_within = kinetic.region_pairs.has_region();
                    assert_eq!(
                        pairs(kinetic.continuous(&start, &end).unwrap()),
                        expected,
                        "case {case}, {i}"
                    );
                    within += usize::from(is_within);
                    colliding += usize::from(is_within && !expected.is_empty());
                }
            }
        }
    }
    assert!(within > threshold(1000) && colliding > threshold(500), "{within} {colliding}");
}

/// After a jump a region begins only if the last region paid over enough steps; with unrelated q no region begins.
#[test]
fn after_a_jump_a_region_begins_only_if_the_last_one_paid() {
    let random = &mut Random(7);
    let model = sheets(random, 1);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    let root = certificates.root_radius().max(1e-3);
    let q = |t: f64| {
        let z: Vec<f64> = (0..model.rank()).map(|k| if k == 0 { t * root } else { 0.0 }).collect();
        certificates.metric().unscale(&z)
    };
    for t in [2.0, -3.0, 1.5, -2.0] {
        kinetic.discrete(&q(t)).unwrap();
        assert!(!kinetic.region_pairs.has_region() && !kinetic.control.has_paid);
    }
    for i in 0..40 {
        kinetic.control.plain_cost = 1_000_000;
        kinetic.discrete(&q(-2.0 + f64::from(i) * 1e-6)).unwrap();
    }
    assert!(kinetic.region_pairs.has_region());
    kinetic.discrete(&q(2.0)).unwrap();
    assert!(kinetic.region_pairs.has_region());
    kinetic.discrete(&q(2.0 + 1e-6)).unwrap();
    assert_eq!(kinetic.region_pairs.steps, 2);
    // A region of two steps is no evidence, however expensive plain queries were.
    for t in [-2.0, 2.0, -1.5] {
        kinetic.discrete(&q(t)).unwrap();
        assert!(!kinetic.region_pairs.has_region());
    }
}

/// The same q again and again is a step of length 0, of which every distance is long enough.
#[test]
fn pairs_that_collide_at_rest_are_tested_in_every_step() {
    let model = three_sheets(5, [-1.2, 0.0, 2.5], false);
    let certificates = tight_certificates(&model, 1 << 10);
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let q = [0.0, 2.5, 0.0];
    let expected = oracle.discrete(&q).unwrap();
    assert!(!expected.is_empty());
    let mut within = 0;
    for _ in 0..8 {
        kinetic.control.plain_cost = 1_000_000;
        assert_eq!(kinetic.discrete(&q).unwrap(), expected);
        assert_eq!(kinetic.pairs(), expected);
        within += usize::from(kinetic.region_pairs.has_region());
    }
    assert!(within > 2, "{within}");
}

/// During a pause no region begins, however expensive plain queries are.
#[test]
fn no_region_begins_during_a_pause() {
    let model = three_sheets(4, [-1.2, 0.0, 2.5], false);
    let certificates = tight_certificates(&model, 0);
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    for is_paused in [true, false] {
        let mut regions = 0;
        for i in 0..8 {
            kinetic.control.plain_cost = 1_000_000;
            if is_paused {
                (kinetic.control.balls.pause, kinetic.control.capsules.pause) = (9, 9);
            } else {
                (kinetic.control.balls.pause, kinetic.control.capsules.pause) = (0, 0);
            }
            // A zigzag, for which there are no capsules.
            let q = [0.0, 2.0 + 1e-4 * f64::from(i), 1e-4 * f64::from(i % 2)];
            kinetic.discrete(&q).unwrap();
            regions += usize::from(kinetic.region_pairs.has_region());
        }
        assert_eq!(regions > 0, !is_paused);
    }
}

/// Returns a query in a ball that was searched a few steps before, where the upper one of three sheets is near the middle one;
/// and its last q. No other region begins soon.
fn query_in_a_ball(model: &ReducedModel, certificates: &Certificates) -> (KineticQuery, [f64; 3]) {
    let mut kinetic = KineticQuery::new(model, certificates).unwrap();
    // A zigzag, for which there are no capsules.
    let path = [0.0, 1e-4, 0.0, 1e-4, 0.0, 1e-4].map(|aside| [0.0, 2.38, aside]);
    for (i, q) in path.iter().enumerate() {
        kinetic.control.plain_cost = 1_000_000;
        kinetic.control.balls.share = 0.05;
        (kinetic.control.balls.pause, kinetic.control.capsules.pause) = (0, 0);
        kinetic.discrete(q).unwrap();
        // Neither the jump to the first q nor a single step has a region.
        assert!(i > 1 || !kinetic.region_pairs.has_region());
    }
    assert!(kinetic.region_pairs.has_region() && kinetic.region_pairs.steps > 1);
    (kinetic.control.balls.pause, kinetic.control.capsules.pause) = (9, 9);
    (kinetic, path[5])
}

/// Returns three sheets with certificates of a large error, which take little time.
fn sheets_near_a_contact(intersects_at_rest: bool) -> (ReducedModel, Certificates) {
    let model = three_sheets(3, [-1.2, 0.0, 2.5], intersects_at_rest);
    let options = CertifyOptions::default().budget(0).epsilon(0.5);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    (model, certificates)
}

/// A region holds neither beyond its radius, however short the way was, nor after a long way within it; then queries are plain
/// ones.
#[test]
fn regions_end_where_z_leaves_them_and_where_it_has_travelled_too_far() {
    let (model, certificates) = sheets_near_a_contact(false);
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let (within, last) = query_in_a_ball(&model, &certificates);
    let steps = within.region_pairs.steps;
    let (near, contact) = ([0.0, last[1], 3e-4], [0.0, 2.5, 0.0]);
    for (radius, travelled) in [(None, None), (Some(1e-5), None), (None, Some(1e3))] {
        let mut kinetic = within.clone();
        kinetic.region.radius = radius.unwrap_or(kinetic.region.radius);
        kinetic.region_pairs.travelled = travelled.unwrap_or(kinetic.region_pairs.travelled);
        let holds = radius.is_none() && travelled.is_none();
        // After a region that did not pay no other one begins soon.
        kinetic.control.plain_cost = 0;
        assert_eq!(kinetic.discrete(&near).unwrap(), oracle.discrete(&near).unwrap());
        assert_eq!(kinetic.region_pairs.has_region(), holds);
        // Only queries in a region are steps of one.
        assert_eq!(kinetic.region_pairs.steps, steps + u64::from(holds));
        let expected = oracle.discrete(&contact).unwrap();
        assert!(!expected.is_empty());
        assert_eq!(kinetic.discrete(&contact).unwrap(), expected);
        assert_eq!(kinetic.pairs(), expected);
    }
}

/// A region proves only motions free that begin at the last q and end in it, within its way and its pairs' safe distances, of
/// models without exceptions. All others are searched.
#[test]
fn motions_within_a_region_are_free_and_no_others() {
    let is_free = |kinetic: &mut KineticQuery, q_t0: &[f64], q_t1: &[f64]| {
        let ends = [q_t0, q_t1].map(|q| kinetic.query.measure(q).unwrap());
        kinetic.is_free_within_region(ends).unwrap()
    };
    for intersects_at_rest in [false, true] {
        let (model, certificates) = sheets_near_a_contact(intersects_at_rest);
        assert_eq!(certificates.exceptions().is_empty(), !intersects_at_rest);
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let (mut kinetic, last) = query_in_a_ball(&model, &certificates);
        let (near, contact) = ([0.0, last[1], 2e-4], [0.0, 2.5, 0.0]);
        assert_eq!(is_free(&mut kinetic, &last, &near), !intersects_at_rest);
        assert!(!is_free(&mut kinetic, &near, &last) && !is_free(&mut kinetic, &last, &contact));
        let mut smaller = kinetic.clone();
        smaller.region.radius = 1e-5;
        assert!(!is_free(&mut smaller, &last, &near));
        let mut farther = kinetic.clone();
        farther.region_pairs.travelled = 1e3;
        assert!(!is_free(&mut farther, &last, &near));
        for (q_t0, q_t1) in [(last, near), (last, contact), (contact, last)] {
            let expected = oracle.continuous(&q_t0, &q_t1).unwrap();
            assert_eq!(expected.is_empty(), !intersects_at_rest && q_t1 == near);
            assert_eq!(kinetic.continuous(&q_t0, &q_t1).unwrap(), expected);
        }
    }
}

/// Two modes that move nothing make `|z|` as large as numbers are, and infinite.
#[test]
fn modes_that_move_nothing_change_no_answer_where_norms_overflow() {
    let (mut colliding, mut overflowing, mut regions) = (0, 0, 0);
    for case in 0..12 {
        let random = &mut Random(case as u64 + 70);
        let model = sheets(random, case);
        let (mesh, rank) = (model.mesh(), model.rank());
        let of_vertex = |v: u32| model.modes().of_vertex(v).iter().copied().chain([DVec3::ZERO; 2]);
        let modes = (0..mesh.rest_positions().len() as u32).flat_map(of_vertex).collect();
        let modes = Modes::new(rank + 2, modes).unwrap();
        let more = ReducedModel::with_metric(mesh.clone(), modes, Metric::identity(rank + 2)).unwrap();
        let options = CertifyOptions::default().epsilon(0.5).budget(64);
        let certificates = Certificates::compute(&more, &options, &()).unwrap();
        let mut oracle =
            Query::without_certificates(&model, crate::parts::Scope::of(&model), Method::BruteForce).unwrap();
        let mut kinetic = KineticQuery::new(&more, &certificates).unwrap();
        let direction: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
        for step in 0..300 {
            let t = if step < 200 { 0.5 + f64::from(step) * 1e-3 } else { f64::from(step - 200) * 0.05 };
            let mut q: Vec<f64> = direction.iter().map(|x| x * t).collect();
            let expected = oracle.discrete(&q).unwrap();
            let far = [0.0, 1e300, 1.7e308, f64::MAX][step as usize / 20 % 4];
            q.extend([far, -far]);
            assert_eq!(kinetic.discrete(&q).unwrap(), expected, "case {case}, step {step}");
            colliding += u32::from(!expected.is_empty());
            overflowing += u32::from(kinetic.statistics().norm == f64::INFINITY);
            regions += u32::from(kinetic.region_pairs.has_region());
        }
    }
    assert!(colliding > 100 && overflowing > 1000 && regions > 10, "{colliding} {overflowing} {regions}");
}
