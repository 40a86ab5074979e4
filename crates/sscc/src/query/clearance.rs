//! Distances of triangles of a model at q. They are those of its positions: no certificate shortens these searches.

use super::query::Query;
use crate::detect::{Detector, detector_of_model};
use crate::{Clearance, Error, NearPair};

impl Query {
    /// All pairs that count and are nearer than a clearance at q, as [`Detector::within`] finds them at the positions.
    ///
    /// # Errors
    /// As [`Query::discrete`]; when there are more than [`Detector::MAX_PAIRS`].
    pub fn within(&mut self, q: &[f64], clearance: &Clearance) -> Result<&[NearPair], Error> {
        self.measure_distances(q, |detector, positions| detector.within(positions, clearance).map(drop))?;
        Ok(self.detector.as_ref().map_or(&[], |detector| detector.near_pairs()))
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
