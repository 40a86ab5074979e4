//! The scope of certificates: the metric, centre, contact filter and exceptions for which they hold.

use crate::filter::{PairFilter, RingPairs};
use crate::model::ScaledModel;
use crate::{Clearance, ContactFilter, DISTANCE_ERROR, Error, Metric, Neighbours, Pair, ReducedModel};

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
    /// Pairs that collide at the centre; with a clearance, pairs that are nearer than it at the centre, or hardly
    /// farther. No radius covers them, and every query tests them. Sorted.
    pub exceptions: Vec<Pair>,
    /// The clearance that triangles keep below the radii, and beyond how many rings. None if the radii only prove that they do
    /// not collide.
    pub clearance: Option<Clearance>,
}

impl Scope {
    /// Returns the default scope of a model: its own metric, centre q = 0, the contact filter of its mesh
    /// ([`ContactFilter::of`]).
    pub fn of(model: &ReducedModel) -> Self {
        Self {
            metric: model.metric().clone(),
            center: vec![0.0; model.rank()],
            filter: ContactFilter::of(model.mesh()),
            exceptions: Vec::new(),
            clearance: None,
        }
    }

    /// Returns the model in scaled coordinates about the centre, whose parts keep the clearance.
    pub(crate) fn scaled_model(&self, model: &ReducedModel) -> ScaledModel {
        let scaled = ScaledModel::new(model, &self.metric, &self.center);
        match self.clearance {
            Some(clearance) => scaled.keeping(clearance.distance(), DISTANCE_ERROR),
            None => scaled,
        }
    }

    /// Returns the pairs that radii cover: those that count and are no exceptions; with a clearance they share no vertex, and are
    /// not within the rings, which are the second part of the result.
    ///
    /// # Errors
    /// If too many pairs are within the rings.
    pub(crate) fn counted_pairs(&self, model: &ReducedModel) -> Result<(PairFilter, RingPairs), Error> {
        let Some(clearance) = self.clearance else {
            let filter = PairFilter::new(model, &self.filter).excluding(&self.exceptions);
            return Ok((filter, RingPairs::NONE));
        };
        let mut filter = self.filter.clone();
        // Triangles with a common vertex are one ring apart.
        filter.neighbours = Neighbours::Exclude;
        let filter = PairFilter::new(model, &filter).excluding(&self.exceptions);
        let rings = match clearance.rings() {
            0 | 1 => RingPairs::NONE,
            rings => RingPairs::new(&filter, rings)?,
        };
        Ok((filter, rings))
    }

    /// Returns `|S (q - center)|`, rounded up.
    pub(crate) fn norm(&self, q: &[f64]) -> f64 {
        if self.center.iter().all(|x| *x == 0.0) {
            return self.metric.length(q);
        }
        self.metric.norm_from(q, &self.center, &mut vec![0.0; q.len()])
    }

    /// Returns the q with scaled coordinates `size z`: `center + S^-1 size z`, up to rounding.
    pub(crate) fn at(&self, z: &[f64], size: f64) -> Vec<f64> {
        let offset = self.metric.unscale(z);
        self.center.iter().zip(offset).map(|(c, d)| c + size * d).collect()
    }
}
