//! Distances of triangles of a model at q. They are those of its positions. Certificates with a clearance shorten the search for near pairs.

use super::query::Query;
use crate::detect::{Detector, detector_of_model};
use crate::{Clearance, Error, NearPair};

impl Query {
    /// All pairs that count and are nearer than a clearance at q, as [`Detector::within`] finds them at the positions.
    ///
    /// Certificates that have this clearance or a larger one, beyond as many rings or fewer, prove most of them farther apart: below the
    /// root's radius one comparison is the answer ([`Statistics::proof`](crate::Statistics::proof)). The pairs are the same with any
    /// certificates.
    ///
    /// # Errors
    /// As [`Query::discrete`]; when there are more than [`Detector::MAX_PAIRS`].
    pub fn within(&mut self, q: &[f64], clearance: &Clearance) -> Result<&[NearPair], Error> {
        if self.near.as_ref().is_some_and(|near| near.is_for(clearance)) {
            return self.within_certified(q, clearance);
        }
        self.measure_distances(q, |detector, positions| detector.within(positions, clearance).map(drop))?;
        Ok(self.detector.as_ref().map_or(&[], |detector| detector.near_pairs()))
    }

    /// The same by certificates.
    fn within_certified(&mut self, q: &[f64], clearance: &Clearance) -> Result<&[NearPair], Error> {
        self.forget();
        let Some(near) = &mut self.near else { return Ok(&[]) };
        self.statistics = near.find(q, clearance, self.context.detect.cancel.as_ref())?;
        self.norm = near.norm;
        Ok(near.pairs())
    }

    /// The nearest two triangles at q that count and are farther apart on the surface than so many rings, as [`Detector::nearest`]
    /// finds them at the positions; none where no pair counts.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn nearest(&mut self, q: &[f64], rings: u32) -> Result<Option<NearPair>, Error> {
        self.measure_distances(q, |detector, positions| detector.nearest(positions, rings))
    }

    /// Asks the detector, which is made by the first question about distances.
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
        self.statistics = detector.statistics();
        found
    }
}
