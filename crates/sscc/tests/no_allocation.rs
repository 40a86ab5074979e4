//! Tests that repeated queries of models and of detectors allocate nothing, and neither does the first query that the
//! root's certificate answers.

#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use glam::DVec3;
use sscc::{Certificates, CertifyOptions, Detector, Method, Modes, Query, ReducedModel, TriMesh};

/// Returns a zigzag strip of `2 n` triangles, bent by modes whose displacements grow along it.
fn strip(n: usize, rank: usize) -> ReducedModel {
    let positions: Vec<DVec3> = (0..2 * n + 2)
        .map(|i| DVec3::new((i / 2) as f64, (i % 2) as f64, 0.1 * ((i / 2) % 3) as f64))
        .collect();
    let faces = (0..2 * n as u32).map(|i| [i, i + 1, i + 2]).collect();
    let modes = Modes::from_matrix(positions.len(), rank, |row, k| {
        let along = (row / 3 / 2) as f64 / n as f64;
        if row % 3 == k % 3 { along.powi(k as i32 / 3 + 1) } else { 0.0 }
    });
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes.unwrap()).unwrap()
}

#[test]
fn queries_allocate_nothing_once_warm() {
    let model = strip(40, 30);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let inside = vec![1e-9; 30];
    let outside: Vec<f64> = (0..30).map(|k| if k == 3 { -60.0 } else { 0.0 }).collect();
    for method in [Method::Certified, Method::BdTree, Method::Traditional] {
        let mut query = Query::with_method(&model, &certificates, method).unwrap();
        assert!(!query.discrete(&outside).unwrap().is_empty(), "{method:?}");
        for q in [&inside, &outside] {
            let counted = allocation_counter::measure(|| {
                query.discrete(q).unwrap();
            });
            assert_eq!(counted.count_total, 0, "{method:?}");
        }
    }
    let mut fresh = Query::new(&model, &certificates).unwrap();
    let counted = allocation_counter::measure(|| {
        fresh.discrete(&inside).unwrap();
    });
    assert!(fresh.statistics().root_certified);
    assert_eq!(counted.count_total, 0, "the first query by the root");
}

#[test]
fn detectors_allocate_nothing_once_warm() {
    let model = strip(200, 3);
    let frames = [0.0, -60.0, 20.0].map(|q| model.positions(&[0.0, 0.0, q]).unwrap());
    let mut detectors = [(); 2].map(|()| Detector::new(model.mesh()));
    let mut answer = || {
        let [a, b] = &mut detectors;
        for x in &frames {
            a.discrete(x).unwrap();
            a.continuous(&frames[0], x).unwrap();
            a.against(x, b, &frames[0]).unwrap();
        }
        a.statistics().rebuilds
    };
    let rebuilds = answer();
    let mut again = 0;
    let counted = allocation_counter::measure(|| again = answer());
    assert_eq!((counted.count_total, again), (0, rebuilds));
}
