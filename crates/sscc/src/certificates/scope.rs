//! What certificates speak of beside the model.

use crate::{Metric, Pair, PairRule, ReducedModel};

/// What certificates speak of beside faces, positions and modes: how `|z|` is measured, and for which pairs of
/// triangles. Certificates for anything else would be a wrong proof.
#[derive(Clone, Debug, PartialEq)]
pub struct Scope {
    /// The metric in which radii are measured.
    pub metric: Metric,
    /// The configuration from which they are measured: `|z| = |S (q - center)|` (r).
    pub center: Vec<f64>,
    /// Which pairs of triangles count.
    pub rule: PairRule,
    /// Pairs that no radius speaks of and every query tests: those that collide at the centre. Sorted.
    pub exceptions: Vec<Pair>,
}

impl Scope {
    /// The default for a model: its own metric, about q = 0, all triangles that share no vertex.
    pub fn of(model: &ReducedModel) -> Self {
        Self {
            metric: model.metric().clone(),
            center: vec![0.0; model.rank()],
            rule: PairRule::default(),
            exceptions: Vec::new(),
        }
    }

    /// `|S (q - center)|`, rounded up.
    pub(crate) fn norm(&self, q: &[f64]) -> f64 {
        self.metric.norm_from(q, &self.center, &mut vec![0.0; q.len()])
    }

    /// The q whose scaled coordinates are `size z`: `center + S^-1 size z`, nearly.
    pub(crate) fn at(&self, z: &[f64], size: f64) -> Vec<f64> {
        let offset = self.metric.unscaled(z);
        self.center.iter().zip(offset).map(|(c, d)| c + size * d).collect()
    }
}
