//! Single queries stop soon when they are cancelled, at any point, and can be used afterwards.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;
use sscc::{
    CancelToken, Certificates, CertifyOptions, Clearance, Detector, Error, KineticQuery, Method, Modes,
    Progress, Query, ReducedModel, ResolveOptions, TriMesh,
};

use crate::common::Random;

/// Counts the checks of its token, which cancels after a number of checks.
#[derive(Clone)]
struct After(Arc<Looks>);

struct Looks {
    looks: AtomicUsize,
    most: AtomicUsize,
}

impl After {
    fn new() -> Self {
        Self(Arc::new(Looks { looks: AtomicUsize::new(0), most: AtomicUsize::new(usize::MAX) }))
    }

    fn token(&self) -> CancelToken {
        let Self(counted) = self.clone();
        CancelToken::when(move || {
            counted.looks.fetch_add(1, Ordering::Relaxed) >= counted.most.load(Ordering::Relaxed)
        })
    }

    /// Resets the count, and lets the next `most` checks pass.
    fn allow(&self, most: usize) {
        self.0.looks.store(0, Ordering::Relaxed);
        self.0.most.store(most, Ordering::Relaxed);
    }

    fn looks(&self) -> usize {
        self.0.looks.load(Ordering::Relaxed)
    }
}

/// Counts reports, and cancels at one of them.
struct AtReport {
    token: CancelToken,
    reports: AtomicUsize,
    last: usize,
}

impl AtReport {
    fn new(last: usize) -> Self {
        Self { token: CancelToken::new(), reports: AtomicUsize::new(0), last }
    }
}

impl Progress for AtReport {
    fn report(&self, _done: usize, _total: usize) {
        if self.reports.fetch_add(1, Ordering::Relaxed) + 1 == self.last {
            self.token.cancel();
        }
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.token)
    }
}

/// Returns a strip with two modes: at (1, 0) all of it is in one point, at (0, 1) it is crumpled.
fn strip(triangles: u32) -> ReducedModel {
    let random = &mut Random::new(3);
    let p: Vec<DVec3> =
        (0..triangles + 2).map(|i| DVec3::new(0.01 * f64::from(i), f64::from(i % 2), 0.0)).collect();
    let faces = (0..triangles).map(|i| [i, i + 1, i + 2]).collect();
    let modes = Modes::new(2, p.iter().flat_map(|x| [-*x, random.vector()]).collect()).unwrap();
    ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap()
}

/// Between two checks, no query tests more than 64 pairs of triangles; brute force tests one row of all pairs.
#[test]
fn queries_check_the_token_after_few_triangle_tests() {
    let model = strip(120);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    for method in [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce] {
        let after = After::new();
        let query = Query::with_method(&model, &certificates, method).unwrap();
        let (mut oracle, mut query) = (query.clone(), query.cancelled_by(after.token()));
        for q in [[1.0, 0.0], [0.0, 1.0]] {
            let expected = oracle.discrete(&q).unwrap().to_vec();
            after.allow(usize::MAX);
            assert_eq!(query.discrete(&q).unwrap(), expected);
            let (all, tests) = (after.looks(), query.statistics().triangle_tests);
            assert!(expected.len() > 1000 && all >= 16, "{method:?}: {all} looks, {tests} tests");
            for most in [0, 1, all / 2, all - 1] {
                let allowed = if method == Method::BruteForce { 120 } else { 64 } * (most as u64 + 1);
                after.allow(most);
                assert_eq!(query.discrete(&q), Err(Error::Cancelled));
                assert!(query.statistics().triangle_tests <= allowed && !query.statistics().complete);
                after.allow(most);
                assert_eq!(query.continuous(&q, &q), Err(Error::Cancelled));
                assert!(query.statistics().triangle_tests <= allowed && !query.statistics().complete);
            }
            after.allow(usize::MAX);
            assert_eq!(query.discrete(&q).unwrap(), expected);
            assert!(query.statistics().complete);
        }
    }
}

/// The last report is that of the radii; then local certificates are computed.
#[test]
fn certificates_can_be_cancelled_after_their_radii() {
    let model = strip(120);
    let options = CertifyOptions::default().threads(1);
    let all = AtReport::new(usize::MAX);
    assert!(Certificates::compute(&model, &options, &all).is_ok());
    let reports = all.reports.load(Ordering::Relaxed);
    assert!(reports > 0);
    let cancelled = Certificates::compute(&model, &options, &AtReport::new(reports));
    assert_eq!(cancelled.err(), Some(Error::Cancelled));
}

/// After a sweep, a resolution or a search for near pairs is cancelled, the statistics say that the answer is incomplete.
#[test]
fn cancelled_answers_are_incomplete() {
    let model = strip(40);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let after = After::new();
    let mut query = Query::new(&model, &certificates).unwrap().cancelled_by(after.token());
    let options = ResolveOptions::default();
    let clearance = Clearance::new(0.1).unwrap().beyond_rings(2);
    let mut detector = Detector::new(model.mesh()).cancelled_by(after.token());
    let mut cancelled = [0; 3];
    // After an answer that is complete, more checks of the token change nothing.
    let mut is_complete = [false; 3];
    for most in 0..400 {
        for kind in 0..3 {
            if is_complete[kind] {
                continue;
            }
            after.allow(most);
            let (error, statistics) = match kind {
                0 => (query.sweep(&[0.0, 0.0], 0, 1.0).err(), query.statistics()),
                1 => (query.resolve(&[1.0, 0.0], &options).err(), query.statistics()),
                _ => {
                    let error = detector.within(model.mesh().rest_positions(), &clearance).err();
                    (error, detector.statistics())
                }
            };
            is_complete[kind] = error.is_none();
            if let Some(error) = error {
                assert_eq!(error, Error::Cancelled);
                assert!(!statistics.complete, "{kind}, {most}");
                cancelled[kind] += 1;
            }
        }
    }
    assert!(cancelled.iter().all(|count| *count > 1), "{cancelled:?}");
}

/// The token of a batch also cancels the current query.
#[test]
fn batches_are_cancelled_within_a_query() {
    let model = strip(120);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let (query, after) = (Query::new(&model, &certificates).unwrap(), After::new());
    after.allow(3);
    assert_eq!(query.batch(&[[1.0, 0.0]], Some(1), &after.token()), Err(Error::Cancelled));
}

/// After a kinetic query is cancelled at any point, in a search or in a step, its next answers are right.
#[test]
fn kinetic_queries_are_right_after_a_cancelled_answer() {
    let model = strip(400);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let after = After::new();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let (mut searches, mut steps, mut right) = (0, 0, 0);
    for base in [0.05, 0.1] {
        let path: Vec<[f64; 2]> = (0..60).map(|i| [0.0, base + 1e-4 * f64::from(i)]).collect();
        let expected: Vec<Vec<_>> = path.iter().map(|q| oracle.discrete(q).unwrap().to_vec()).collect();
        for stride in 2..12 {
            let mut kinetic = KineticQuery::new(&model, &certificates).unwrap().cancelled_by(after.token());
            for (i, (q, expected)) in path.iter().zip(&expected).enumerate() {
                after.allow(if i % stride == 1 { i / stride % 8 } else { usize::MAX });
                let found = kinetic.discrete(q).map(<[_]>::to_vec);
                // A step opens no nodes.
                let is_step = kinetic.statistics().opened == 0;
                match found {
                    Ok(pairs) => {
                        assert_eq!(pairs, *expected);
                        right += usize::from(is_step);
                    }
                    Err(error) => {
                        assert_eq!(error, Error::Cancelled);
                        *(if is_step { &mut steps } else { &mut searches }) += 1;
                    }
                }
            }
        }
    }
    assert!(searches > 30 && steps > 60 && right > 300, "{searches} {steps} {right}");
}
