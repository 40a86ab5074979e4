//! Continuous queries: which pairs of triangles meet between two configurations, and when (paper, section 7).

use super::Query;
use crate::detect::search::Finder;
use crate::{Error, Pair};

/// Two triangles that meet on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The triangles, the lower number first.
    pub pair: Pair,
    /// The time at which they do, from 0 to 1: never later than the true time, see [`Query::continuous`].
    pub time: f64,
}

impl Impact {
    /// How close two triangles must come to be listed though they do not touch: this share (2^-40, about 1e-12) of
    /// their size, see [`impact_triangle_triangle`](crate::impact_triangle_triangle). Well above what rounding can
    /// tell.
    pub const TOLERANCE: f64 = 1.0 / (1_u64 << 40) as f64;
}

impl Query<'_> {
    /// All pairs that meet while every vertex moves on a straight line from its position at `q_t0` to that at `q_t1`
    /// (the computed ones, see [`deformed_position`](crate::deformed_position)), sorted by pair, with the time of
    /// impact of each.
    ///
    /// None is missed: whatever has a point in common at any time from 0 to 1, both ends included, is listed,
    /// with a time that is never later than the true one, and at which their distance is at most [`Impact::TOLERANCE`]
    /// times their size. Only pairs that come that near without a contact can differ between methods. Triangles that
    /// share exactly one vertex, where the rule includes them, are listed when the edge opposite to it of one of them
    /// meets the other, which is what they must do to have another point in common.
    ///
    /// A certificate holds for the way when it holds for both ends: its region is convex, and what a
    /// radius grants to rounding (see `bounds/scaled.rs`) is granted at the radius itself, which covers
    /// positions between two rounded ones. So [`Query::norm`] is the larger one of both ends.
    ///
    /// # Errors
    /// As [`Query::discrete`], for both ends.
    pub fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        let ends = self.begin([q_t0, q_t1], usize::MAX)?;
        let finder = self
            .continuous
            .get_or_insert_with(|| Box::new(Finder::new(&self.discrete.boxes.tables, self.asked.method)));
        finder.begin(usize::MAX);
        let answer = finder.find(&self.asked, &ends);
        self.discrete.statistics = finder.statistics;
        answer?;
        self.discrete.found.extend(finder.found.iter().map(|impact| impact.pair));
        Ok(&finder.found)
    }

    /// The earliest [`Impact::time`] of all pairs between two configurations: the shape is free before.
    ///
    /// # Errors
    /// As [`Query::continuous`].
    pub fn time_of_impact(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<Option<f64>, Error> {
        Ok(self.continuous(q_t0, q_t1)?.iter().map(|impact| impact.time).min_by(f64::total_cmp))
    }
}
