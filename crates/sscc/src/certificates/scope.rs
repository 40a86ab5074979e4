//! The scope of certificates: the metric, centre, contact filter and exceptions for which they hold.

use crate::{ContactFilter, Metric, Pair, ReducedModel};

/// The data beside faces, positions and modes for which certificates hold: it defines `|z|`, and which pairs of
/// triangles count.
///
/// For another scope the same radii would be a wrong proof. So the scope is hashed into the
/// [`Digest`](crate::parts::Digest), stored with the certificates, and queries take it from them.
#[derive(Clone, Debug, PartialEq)]
pub struct Scope {
    /// The metric in which radii are measured.
    pub metric: Metric,
    /// The configuration from which radii are measured: `|z| = |S (q - center)|` (r entries).
    pub center: Vec<f64>,
    /// Which pairs of triangles count.
    pub filter: ContactFilter,
    /// Pairs that collide at the centre: no radius covers them, and every query tests them. Sorted.
    pub exceptions: Vec<Pair>,
}

impl Scope {
    /// The default scope of a model: its own metric, centre q = 0, the contact filter of its mesh ([`ContactFilter::of`]).
    pub fn of(model: &ReducedModel) -> Self {
        Self {
            metric: model.metric().clone(),
            center: vec![0.0; model.rank()],
            filter: ContactFilter::of(model.mesh()),
            exceptions: Vec::new(),
        }
    }

    /// `|S (q - center)|`, rounded up.
    pub(crate) fn norm(&self, q: &[f64]) -> f64 {
        if self.center.iter().all(|x| *x == 0.0) {
            return self.metric.length(q);
        }
        self.metric.norm_from(q, &self.center, &mut vec![0.0; q.len()])
    }

    /// The q with scaled coordinates `size z`: `center + S^-1 size z`, up to rounding.
    pub(crate) fn at(&self, z: &[f64], size: f64) -> Vec<f64> {
        let offset = self.metric.unscale(z);
        self.center.iter().zip(offset).map(|(c, d)| c + size * d).collect()
    }
}
