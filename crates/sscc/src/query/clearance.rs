//! Distances between triangles of a model at q, at its deformed positions. Certificates with a clearance shorten the search for near
//! pairs.

use super::query::Query;
use crate::detect::answer::Statistics;
use crate::detect::{Detector, detector_of_model};
use crate::{Clearance, Error, NearPair};

impl Query {
    /// Returns all pairs that count and are nearer than a clearance at q, as [`Detector::within`] finds them at the positions.
    ///
    /// Certificates with this clearance or a larger one, and as many rings or fewer, prove most pairs farther apart:
    /// below the root's radius a query is one comparison if there are no exceptions
    /// ([`Statistics::proof`](crate::Statistics::proof)). The pairs are the same with any certificates.
    ///
    /// # Errors
    /// As [`Query::discrete`]; when there are more than [`Detector::MAX_PAIRS`] near pairs, including those within the
    /// rings.
    pub fn within(&mut self, q: &[f64], clearance: &Clearance) -> Result<&[NearPair], Error> {
        if self.near.as_ref().is_some_and(|near| near.is_for(clearance)) {
            return self.within_certified(q, clearance);
        }
        self.measure_distances(q, |detector, positions| detector.within(positions, clearance).map(drop))?;
        Ok(self.detector.as_ref().map_or(&[], |detector| detector.near_pairs()))
    }

    /// Returns the pairs of [`Query::within`], found with the certificates.
    fn within_certified(&mut self, q: &[f64], clearance: &Clearance) -> Result<&[NearPair], Error> {
        self.forget();
        let Some(near) = &mut self.near else { return Ok(&[]) };
        let found = near.find(q, clearance, self.context.detect.cancel.as_ref(), &mut self.statistics);
        self.norm = near.norm;
        found?;
        Ok(near.pairs())
    }

    /// Returns the nearest two triangles at q that count and are not within `rings` rings of each other on the surface, as
    /// [`Detector::nearest`] finds them at the positions; `None` if no pair counts.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn nearest(&mut self, q: &[f64], rings: u32) -> Result<Option<NearPair>, Error> {
        self.measure_distances(q, |detector, positions| detector.nearest(positions, rings))
    }

    /// Queries the detector, which the first query of distances creates.
    fn measure_distances<T>(
        &mut self,
        q: &[f64],
        ask: impl FnOnce(&mut Detector, &[glam::DVec3]) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.forget();
        self.norm = self.measure(q)?.norm;
        let positions = self.context.model.positions(q)?;
        let detector = match self.detector.take() {
            Some(detector) => *detector,
            None => detector_of_model(&self.context.model, &self.context.scope.filter)?,
        };
        let detector = detector.cancelled_by(self.context.detect.cancel.clone());
        let detector = self.detector.insert(Box::new(detector));
        let found = ask(detector, &positions);
        // Cost and rebuilds of the detector's hierarchy are no part of the statistics of a query.
        self.statistics = Statistics { tree_cost: 0.0, rebuilds: 0, ..detector.statistics() };
        found
    }
}
