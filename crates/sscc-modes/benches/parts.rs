//! Bench of the parts of queries and certificates, on the elastic spring: `cargo bench -p sscc-modes --bench parts`.
#![allow(clippy::expect_used)]

use divan::{Bencher, black_box};
use glam::DVec3;
use sscc::{
    Certificates, CertifyOptions, KineticQuery, Method, MovingTriangle, Query, ReducedModel,
    impact_triangle_triangle, intersect_triangle_triangle,
};
use sscc_modes::shapes::elastic_spring;
use std::sync::LazyLock;

/// Spring (16,000 triangles, 20 linear modes) with its certificates.
static SPRING: LazyLock<(ReducedModel, Certificates)> = LazyLock::new(|| {
    let model = elastic_spring(&()).expect("the embedded spring").model;
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).expect("certificates");
    (model, certificates)
});

/// Norms of q relative to the root's radius: certified by the root, certified by node pairs, and with collisions.
const NORMS: [f64; 3] = [0.5, 2.0, 8.0];

fn main() {
    divan::main();
}

/// Returns a q of this norm, relative to the root's radius.
fn q_at(norm: f64) -> Vec<f64> {
    let (model, certificates) = &*SPRING;
    let z: Vec<f64> = (0..model.rank()).map(|k| (1.0 + 2.0 * k as f64).sin() / (1.0 + k as f64)).collect();
    let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
    let size = norm * certificates.root_radius() / length;
    model.metric().unscaled(&z.iter().map(|z| z * size).collect::<Vec<_>>()).unwrap_or_default()
}

#[divan::bench(args = NORMS)]
fn discrete(bencher: Bencher, norm: f64) {
    let (model, certificates) = &*SPRING;
    let (q, mut query) = (q_at(norm), Query::new(model, certificates).expect("its own certificates"));
    bencher.bench_local(|| query.discrete(black_box(&q)).expect("a valid q").len());
}

#[divan::bench(args = [Method::BdTree, Method::Traditional, Method::NormalCones])]
fn discrete_by(bencher: Bencher, method: Method) {
    let (model, certificates) = &*SPRING;
    let mut query = Query::with_method(model, certificates, method).expect("its own certificates");
    let q = q_at(2.0);
    bencher.bench_local(|| query.discrete(black_box(&q)).expect("a valid q").len());
}

#[divan::bench(args = NORMS)]
fn continuous(bencher: Bencher, norm: f64) {
    let (model, certificates) = &*SPRING;
    let (q_t0, q_t1) = (q_at(norm), q_at(1.01 * norm));
    let mut query = Query::new(model, certificates).expect("its own certificates");
    bencher.bench_local(|| query.continuous(black_box(&q_t0), &q_t1).expect("a valid q").len());
}

/// A sequence of small steps forward and back.
#[divan::bench(args = NORMS)]
fn kinetic(bencher: Bencher, norm: f64) {
    let (model, certificates) = &*SPRING;
    let steps: Vec<Vec<f64>> = (0..64).map(|i| q_at(norm * (1.0 + 1e-4 * f64::from(i)))).collect();
    let sequence: Vec<&Vec<f64>> = steps.iter().chain(steps.iter().rev()).collect();
    let mut query = KineticQuery::new(model, certificates).expect("its own certificates");
    let mut next = 0;
    bencher.bench_local(|| {
        next = (next + 1) % sequence.len();
        query.discrete(sequence[next]).expect("a valid q").len()
    });
}

#[divan::bench(sample_count = 5)]
fn certify(bencher: Bencher) {
    let model = &SPRING.0;
    bencher
        .bench_local(|| Certificates::compute(model, &CertifyOptions::default(), &()).expect("certificates"));
}

/// Two parallel triangles at a distance of 0.1.
fn triangles() -> [[DVec3; 3]; 2] {
    [0.0, 0.1].map(|z| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z))
}

#[divan::bench]
fn triangle_triangle(bencher: Bencher) {
    let [a, b] = triangles();
    bencher.bench_local(|| intersect_triangle_triangle(black_box(&a), black_box(&b)));
}

/// A triangle that passes through another one.
#[divan::bench]
fn moving_triangles(bencher: Bencher) {
    let [a, b] = triangles();
    let still = MovingTriangle { t0: a, t1: a };
    let moving = MovingTriangle { t0: b, t1: b.map(|p| p - DVec3::Z * 0.3) };
    bencher.bench_local(|| impact_triangle_triangle(black_box(&still), black_box(&moving), 1e-12));
}
