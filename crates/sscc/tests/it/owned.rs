//! Queries and detectors are owned values: they outlive the data from which they were made, and can be sent to other threads.

use std::fmt::Debug;
use std::thread;

use glam::DVec3;
use sscc::parts::{PosedShape, Scope, SweptShape};
use sscc::{
    Answer, Certificates, CertifyOptions, ContactFilter, Detector, KineticQuery, Pair, Query, ReducedModel,
};

use crate::common::{Random, random_model};

/// The data that an engine keeps for a shape.
#[derive(Clone)]
struct Collider {
    query: Query,
    detector: Detector,
    model: ReducedModel,
}

impl Collider {
    fn new(model: ReducedModel) -> Self {
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let query = Query::new(&model, &certificates).unwrap();
        Self { query, detector: Detector::new(model.mesh()), model }
    }

    /// Returns the pairs at q, by the query and by the detector.
    fn pairs(&mut self, q: &[f64]) -> [Vec<Pair>; 2] {
        let positions: Vec<DVec3> = self.model.positions(q).unwrap();
        [self.query.discrete(q).unwrap().to_vec(), self.detector.discrete(&positions).unwrap().to_vec()]
    }
}

#[test]
fn one_struct_with_a_query_and_a_detector_serves_four_threads() {
    let mut found = 0;
    for seed in 0..40 {
        let model = random_model(seed);
        if model.mesh().has_split_vertices() {
            continue;
        }
        let collider = Collider::new(model);
        let work = |mut collider: Collider, seed: u64| {
            let random = &mut Random::new(seed);
            (0..8)
                .map(|_| {
                    let q: Vec<f64> = (0..collider.model.rank()).map(|_| random.signed()).collect();
                    collider.pairs(&q)
                })
                .collect::<Vec<_>>()
        };
        let threads = [(); 4].map(|()| {
            let collider = collider.clone();
            thread::spawn(move || work(collider, seed + 900))
        });
        let here = work(collider, seed + 900);
        for answers in threads.map(|thread| thread.join().unwrap()) {
            assert_eq!(answers, here);
        }
        for [of_query, of_detector] in here {
            assert_eq!(of_query, of_detector);
            found += of_query.len();
        }
    }
    assert!(found > 0);
}

/// Compiles only if all types are `Clone`, `Debug`, `Send`, `Sync` and without lifetimes.
#[test]
fn public_types_are_owned() {
    fn is_owned<T: Clone + Debug + Send + Sync + 'static>() {}
    is_owned::<Query>();
    is_owned::<KineticQuery>();
    is_owned::<Detector>();
    is_owned::<PosedShape>();
    is_owned::<SweptShape>();
    is_owned::<ReducedModel>();
    is_owned::<Certificates>();
    is_owned::<CertifyOptions>();
    is_owned::<Scope>();
    is_owned::<ContactFilter>();
    is_owned::<Answer>();
    is_owned::<sscc::AuditReport>();
    is_owned::<sscc::CancelToken>();
    is_owned::<sscc::parts::ContactCurves>();
    is_owned::<sscc::Error>();
    is_owned::<sscc::FreeSamples>();
    is_owned::<sscc::Impact>();
    is_owned::<sscc::Metric>();
    is_owned::<sscc::Modes>();
    is_owned::<sscc::Resolved>();
    is_owned::<sscc::Statistics>();
    is_owned::<sscc::Sweep>();
    is_owned::<sscc::TriMesh>();
    is_owned::<sscc::TriangleGroups>();
    is_owned::<sscc::parts::Hierarchy>();
}
