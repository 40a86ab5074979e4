//! The scales along a line from the centre up to which local certificates prove nodes and pairs of nodes free.
//!
//! A certificate that holds during the straight motion from the centre to some point of the line proves its pairs free at all
//! points before it. Certificates are evaluated at a few scales only; radii and conservative advancement bound all other pairs.

use super::configuration_check::ConfigurationCheck;
use super::context::QueryContext;
use super::local_proofs::LocalProofs;
use super::local_tables::LocalTables;
use crate::certificates::Certificates;
use crate::detect::vertex_motion::DeformedMotion;
use crate::hierarchy::NodePair;

/// The largest number of scales at which certificates are evaluated.
const MOST_SCALES: usize = 6;

/// The quotient of a scale and the next smaller one. Only the time depends on it.
const STEP: f64 = 1.5;

/// The proofs of local certificates up to some scales of one line.
pub(super) struct LocalScales<'a> {
    tables: &'a LocalTables,
    /// The scales, the largest first.
    proofs: Vec<(f64, LocalProofs<2>)>,
}

impl<'a> LocalScales<'a> {
    /// Evaluates certificates at scales from `largest` down to that at which the root's radius is reached. `norm`: `|z|` at scale 1.
    /// `None` if the query uses no local certificates.
    pub(super) fn new(
        context: &'a QueryContext,
        check: &mut ConfigurationCheck,
        q: &[f64],
        norm: f64,
        largest: f64,
    ) -> Option<Self> {
        let tables = context.locals.as_deref()?;
        let node_radii = &context.used_certificates()?.node_radii;
        let center = &tables.center;
        let root_scale = context.certificates.as_ref().map_or(0.0, Certificates::root_radius) / norm;
        let mut scale = largest;
        let mut proofs = Vec::new();
        let is_cancelled = || context.detect.is_cancelled();
        // Division does not make the smallest numbers smaller, so the loop would not end.
        let is_normal = |scale: f64| scale.is_finite() && scale >= f64::MIN_POSITIVE;
        while proofs.len() < MOST_SCALES && scale > root_scale && is_normal(scale) && !is_cancelled() {
            let end: Vec<f64> = center.iter().zip(q).map(|(c, q)| c + scale * (q - c)).collect();
            if let Ok(configuration) = check.measure(context, &end) {
                // This reach bounds the rounding at both ends, and at points between them.
                let reach = configuration.reach.max(context.model.reach(center));
                let mut all = LocalProofs::new(tables);
                let start = with_mutant!(center, LocalScaleOfEnd, &end[..]);
                if all.begin(tables, &DeformedMotion::new([start, &end], reach)) {
                    all.prove(tables, &context.detect.hierarchy, node_radii, configuration.norm);
                    proofs.push((scale, all));
                }
            }
            scale /= STEP;
        }
        Some(Self { tables, proofs })
    }

    /// Returns a scale up to which no triangle of one node collides with one of the other (for n = m: no two triangles of the node
    /// collide).
    pub(super) fn of_pair(&mut self, (n, m): NodePair) -> f64 {
        let Self { tables, proofs } = self;
        let is_proven = |proofs: &mut LocalProofs<2>| {
            if n == m { proofs.is_node_proven(tables, n) } else { proofs.is_pair_proven(tables, (n, m)) }
        };
        proofs.iter_mut().find_map(|(scale, proofs)| is_proven(proofs).then_some(*scale)).unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::square;
    use crate::{Certificates, CertifyOptions, Modes, Query, ReducedModel};

    #[test]
    fn lines_begin_at_the_centre() {
        // The mode stretches a square along x; nothing is left of it at -1.
        let mesh = square(8);
        let modes = mesh.rest_positions().iter().map(|p| p.with_y(0.0)).collect();
        let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
        let options = CertifyOptions::default().center(vec![0.5]).local_budget(1 << 20);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        assert_eq!(certificates.parts().local.nodes.first(), Some(&0));
        let mut query = Query::new(&model, &certificates).unwrap();
        assert_eq!(query.measure(&[0.5]).unwrap().norm, 0.0);
        let q = [-2.0];
        let norm = query.measure(&q).unwrap().norm;
        let mut scales = LocalScales::new(&query.context, &mut query.check, &q, norm, 0.7).unwrap();
        let found = scales.of_pair((0, 0));
        assert!(found < 0.6, "{found}");
    }
}
