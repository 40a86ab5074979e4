//! A ball about the centre in which every q is valid and the reach is bounded, so that a query need not check q. Its
//! radius is the root's radius, or 0 where there is no such ball.

use super::context::QueryContext;
use crate::limits;

/// A ball about the centre in which every q is a configuration of the model.
#[derive(Clone, Copy)]
pub(super) struct ValidBall {
    /// The radius of the ball, that of the root; 0 if there is no such ball.
    pub(super) radius: f64,
    /// An upper bound of the magnitude of every term of every position at any q in it.
    pub(super) reach: f64,
}

/// Covers a few roundings for each mode.
const UP: f64 = 1.0 + 1e-9;

impl ValidBall {
    pub(super) fn new(context: &QueryContext) -> Self {
        let (model, scope) = (&context.model, &context.scope);
        let none = Self { radius: 0.0, reach: 0.0 };
        let Some(parts) = context.used_certificates().filter(|_| scope.metric.dense_factor().is_none())
        else {
            return none;
        };
        // The largest displacement by one mode alone at |z| = 1.
        let unit = |(k, scale): (usize, f64)| model.mode_displacement_bound(k, UP / scale);
        let rate = scope.metric.scales().into_iter().enumerate().map(unit).map(|x| x * x).sum::<f64>().sqrt();
        let radius = parts.node_radii[0];
        let moved = with_mutant!(radius * rate, ReachOfBallAtCenter, 0.0);
        let reach = (model.reach(&scope.center) + moved) * UP;
        // NaN must fail this test, too.
        if reach * UP <= limits::LARGEST { Self { radius, reach } } else { none }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::ValidBall;
    use crate::{
        Certificates, CertifyOptions, Error, Metric, MetricKind, Modes, Query, ReducedModel, TriMesh,
    };

    /// Returns two triangles at a distance of 1, with modes of very different lengths.
    fn model(scales: Vec<f64>) -> ReducedModel {
        let corners = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z);
        let mesh = TriMesh::new([corners(0.0), corners(1.0)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let entry = |row: usize, k: usize| ((row * 7 + k * 3) as f64).sin() * 10.0_f64.powi(3 * k as i32);
        let modes = Modes::from_matrix(6, scales.len(), entry).unwrap();
        let metric = Metric::from_scales(MetricKind::Given, scales).unwrap();
        ReducedModel::with_metric(mesh, modes, metric).unwrap()
    }

    #[test]
    fn every_q_in_the_ball_is_within_its_reach() {
        for center in [vec![0.0; 3], vec![1e-3, -2e-5, 1e-7]] {
            let model = model(vec![1.0, 1e3, 3e6]);
            let options = CertifyOptions::default().center(center.clone());
            let certificates = Certificates::compute(&model, &options, &()).unwrap();
            let query = Query::new(&model, &certificates).unwrap();
            let valid_ball = ValidBall::new(&query.context);
            assert_eq!(valid_ball.radius, certificates.root_radius());
            let mut largest = 0.0_f64;
            for i in 0..1000 {
                let z: Vec<f64> = (0..3).map(|k| (f64::from(i) * (k as f64 + 1.3)).sin()).collect();
                let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
                let z: Vec<f64> = z.iter().map(|z| z / length * valid_ball.radius).collect();
                let d = model.metric().unscale(&z);
                let q: Vec<f64> = center.iter().zip(d).map(|(c, d)| c + d).collect();
                largest = largest.max(model.reach(&q));
            }
            assert!(largest <= valid_ball.reach && largest > 0.7 * valid_ball.reach, "{largest}");
        }
    }

    #[test]
    fn invalid_q_are_refused() {
        let model = model(vec![1.0, 1e3, 3e6]);
        let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
        let mut query = Query::new(&model, &certificates).unwrap();
        assert!(query.discrete(&[0.0, 0.0, 0.0]).is_ok() && query.statistics().root_certified);
        assert!(matches!(query.discrete(&[0.0, 0.0]), Err(Error::CoordinatesLength { found: 2, rank: 3 })));
        assert!(matches!(
            query.discrete(&[0.0, f64::NAN, 0.0]),
            Err(Error::CoordinatesValue { index: 1, .. })
        ));
        assert!(matches!(query.discrete(&[1e300, 0.0, 0.0]), Err(Error::CoordinatesRange)));
    }

    #[test]
    fn the_reach_follows_the_lengths_of_modes() {
        for size in [1e-3, 1.0, 1e3] {
            let model = model([1.0, 1e3, 3e6].map(|x| x * size).to_vec());
            let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
            let query = Query::new(&model, &certificates).unwrap();
            let ball = ValidBall::new(&query.context);
            let scales = model.metric().scales();
            let rates = scales.iter().enumerate().map(|(k, s)| model.mode_displacement_bound(k, 1.0) / s);
            let expected = ball.radius * rates.map(|x| x.powi(2)).sum::<f64>().sqrt();
            let moved = ball.reach - model.reach(&[0.0; 3]);
            assert!(
                expected > 0.0 && moved >= expected && moved < expected * (1.0 + 1e-6),
                "{size}: {moved}"
            );
        }
    }
}
