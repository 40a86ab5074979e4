//! Continuous queries: which pairs of triangles collide between two configurations, and when (paper, section 7).

use super::configuration_search::SweptSearch;
use super::query::Query;
use crate::detect::answer::Statistics;
use crate::{Detector, Error, Impact};

impl Query {
    /// Returns all pairs that collide while every vertex moves on a straight line from its position at `q_t0` to that at
    /// `q_t1` (the computed ones, see [`deformed_position`](crate::deformed_position)), sorted by pair, each with its time
    /// of impact.
    ///
    /// No pair is missed: every pair with a point in common at any time from 0 to 1, 0 and 1 included, is listed, with
    /// a time that is never later than the true one, and at which the distance is at most [`Impact::TOLERANCE`] times
    /// the size of the triangles (unless the test of a pair ends at its limit of about 10,000 steps: then the distance at
    /// the listed time may be larger). Only pairs that come that close without a contact can differ between methods. Triangles that share
    /// exactly one vertex, where the contact filter includes them, are listed if in one of them the edge opposite to
    /// this vertex meets the other triangle; otherwise they have no other point in common.
    ///
    /// A certificate holds during the motion if it holds at start and end: its region is convex, and a radius contains the
    /// rounding bound at the radius itself, which covers positions between two rounded ones. So [`Statistics::norm`] is the
    /// larger norm of start and end.
    ///
    /// ```
    /// # use glam::DVec3;
    /// use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, TriMesh};
    ///
    /// # fn main() -> Result<(), sscc::Error> {
    /// # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    /// # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
    /// # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
    /// # let model = ReducedModel::new(mesh, modes)?;
    /// # let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    /// // The second of two triangles, one unit apart, falls through the first.
    /// let mut query = Query::new(&model, &certificates)?;
    /// assert!(query.discrete(&[2.0])?.is_empty()); // it has passed
    /// let impacts = query.continuous(&[0.0], &[2.0])?;
    /// assert_eq!((impacts.len(), impacts[0].pair), (1, (0, 1)));
    /// assert!((impacts[0].time - 0.5).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Query::discrete`], for start and end.
    pub fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.continuous_at_most(q_t0, q_t1, usize::MAX)
    }

    /// Returns impacts as [`Query::continuous`], at most `limit` of them; which ones is not fixed. Where the limit stopped
    /// the query, [`Statistics::complete`] is false.
    pub(super) fn continuous_at_most(
        &mut self,
        q_t0: &[f64],
        q_t1: &[f64],
        limit: usize,
    ) -> Result<&[Impact], Error> {
        self.forget();
        let [t0, t1] = [self.measure(q_t0)?, self.measure(q_t1)?];
        self.norm = with_mutant!(t0.norm.max(t1.norm), SweptNormAtStart, t1.norm);
        // The memory of the swept search is allocated only where it is needed.
        if self.context.is_proven_free(self.norm) {
            self.statistics = Statistics::PROVEN_FREE;
            return Ok(&[]);
        }
        let swept = self.swept.get_or_insert_with(|| Box::new(SweptSearch::new(&self.context)));
        let most = limit.min(Detector::MAX_PAIRS);
        swept.find(&self.context, [t0, t1], self.norm, most, &mut self.statistics)?;
        Detector::check_limit(limit, self.statistics.complete)?;
        let impacts = &mut swept.narrow.0.list;
        impacts.sort_unstable_by_key(|impact| impact.pair);
        self.discrete.narrow.0.list.extend(impacts.iter().map(|impact| impact.pair));
        Ok(impacts)
    }

    /// Returns the earliest [`Impact::time`] of all pairs between two configurations: before this time the shape is
    /// free. None if no pair collides.
    ///
    /// # Errors
    /// As [`Query::continuous`].
    pub fn time_of_impact(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<Option<f64>, Error> {
        Ok(self.continuous(q_t0, q_t1)?.iter().map(|impact| impact.time).min_by(f64::total_cmp))
    }
}
