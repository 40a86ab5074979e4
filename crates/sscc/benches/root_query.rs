//! A query that the root's certificate answers: the norm of q, one comparison. `cargo bench -p sscc`.
#![allow(clippy::expect_used)]

use divan::{Bencher, black_box};
use glam::DVec3;
use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};

fn main() {
    divan::main();
}

/// Two triangles one apart, each mode moving one corner: the mesh does not matter for this query.
fn model(rank: usize) -> ReducedModel {
    let positions: Vec<DVec3> = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
        .map(|(x, y, z)| DVec3::new(f64::from(x), f64::from(y), f64::from(z)))
        .to_vec();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).expect("a valid mesh");
    let modes = Modes::from_matrix(6, rank, |row, k| if row == k % 18 { 1.0 } else { 0.0 });
    ReducedModel::new(mesh, modes.expect("valid modes")).expect("a valid model")
}

#[divan::bench(args = [10, 20, 30, 60])]
fn root_certified(bencher: Bencher, rank: usize) {
    let model = model(rank);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).expect("certificates");
    let mut query = Query::new(&model, &certificates).expect("its own certificates");
    let q: Vec<f64> = (0..rank).map(|k| 1e-3 / (k + 1) as f64).collect();
    assert!(query.discrete(&q).expect("a valid q").is_empty() && query.statistics().root_certified);
    bencher.bench_local(|| query.discrete(black_box(&q)).expect("a valid q").len());
}
