//! Certificates through the public interface.

use glam::DVec3;
use sscc::{Certificates, CertifyOptions, Method, Metric, MetricKind, Modes, Query, ReducedModel, TriMesh};

/// `U / S` vanishes (1e-360), but U moves: nothing may be promised for ever.
#[test]
fn scaled_modes_that_vanish_promise_nothing() {
    let size = 1e-50;
    let flat = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * size);
    let above = [DVec3::new(0.2, 0.2, 1e-4), DVec3::new(0.4, 0.2, 1e-4), DVec3::new(0.2, 0.4, 1e-4)].map(|p| p * size);
    let mesh = TriMesh::new([flat, above].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mut modes = vec![DVec3::ZERO; 6];
    modes[3] = DVec3::Z * -1e-60;
    let modes = Modes::new(1, modes).unwrap();
    let metric = Metric::from_scales(MetricKind::Given, vec![1e300]).unwrap();
    let Ok(model) = ReducedModel::with_metric(mesh, modes, metric) else { return };
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let q = [1e7];
    let mut query = Query::new(&model, &certificates).unwrap();
    let mut oracle = Query::without_certificates(&model, Method::BruteForce);
    println!("{} {}", certificates.root_radius(), query.metric().norm(&q));
    assert_eq!(query.discrete(&q).unwrap(), oracle.discrete(&q).unwrap());
}
