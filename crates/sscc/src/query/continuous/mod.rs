//! Continuous queries: which pairs of triangles meet between two configurations, and when (paper, section 7).

mod brute_force;
mod swept_boxes;
mod traversal;

use super::{Method, Query};
use crate::{Error, Pair, impact_triangle_triangle};
use swept_boxes::SweptBoxes;

/// Two triangles that meet on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The triangles, the lower number first.
    pub pair: Pair,
    /// The time at which they do, from 0 to 1: never later than the true time, see [`Query::continuous`].
    pub time: f64,
}

impl Impact {
    /// How close two triangles must come to be listed though they do not touch: this share (2^-40, about 1e-12) of their
    /// size, see [`impact_triangle_triangle`]. Well above what rounding can tell.
    pub const TOLERANCE: f64 = 1.0 / (1_u64 << 40) as f64;
}

/// What continuous queries need beside the discrete ones; made by the first of them.
#[derive(Clone)]
pub(super) struct Continuous {
    boxes: SweptBoxes,
    impacts: Vec<Impact>,
}

/// The two ends of a motion.
type Ends<'q> = [&'q [f64]; 2];

impl Query<'_> {
    /// All pairs that meet while every vertex moves on a straight line from its position at `q_t0` to that at `q_t1`
    /// (the computed ones, see [`deformed_position`](crate::deformed_position)), sorted by pair, with the time of impact of each.
    ///
    /// None is missed: whatever has a point in common at any time from 0 to 1, both ends included, is listed,
    /// with a time that is never later than the true one. A pair listed without need has come as near as
    /// [`Impact::TOLERANCE`], and nothing but such pairs can differ between methods. Triangles that share exactly one vertex, where
    /// the rule includes them, are listed when the edge opposite to it of one of them meets the other, which is what they
    /// must do to have another point in common.
    ///
    /// A certificate holds for the way when it holds for both ends: its region is convex, and what a
    /// radius grants to rounding (see `bounds/scaled.rs`) is granted at the radius itself, which covers
    /// positions between two rounded ones. So [`Query::norm`] is the larger one of both ends.
    ///
    /// # Errors
    /// As [`Query::discrete`], for both ends.
    pub fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        let reach = self.begin(q_t0, usize::MAX)?;
        let norm = self.norm;
        let reach = reach.max(self.begin(q_t1, usize::MAX)?);
        self.norm = self.norm.max(norm);
        let mut state = match self.continuous.take() {
            Some(state) => state,
            None => Box::new(Continuous {
                boxes: SweptBoxes::new(self.model, &self.hierarchy, self.method, self.boxes.bd_tree()),
                impacts: Vec::new(),
            }),
        };
        state.impacts.clear();
        let answer = self.find_impacts(&mut state, [q_t0, q_t1], reach);
        let impacts = &mut self.continuous.insert(state).impacts;
        answer?;
        impacts.sort_unstable_by_key(|impact| impact.pair);
        self.pairs.extend(impacts.iter().map(|impact| impact.pair));
        self.statistics.complete = true;
        Ok(impacts)
    }

    /// The earliest [`Impact::time`] of all pairs between two configurations: the shape is free before.
    ///
    /// # Errors
    /// As [`Query::continuous`].
    pub fn time_of_impact(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<Option<f64>, Error> {
        Ok(self.continuous(q_t0, q_t1)?.iter().map(|impact| impact.time).min_by(f64::total_cmp))
    }

    fn find_impacts(&mut self, state: &mut Continuous, q: Ends<'_>, reach: f64) -> Result<(), Error> {
        if self.method == Method::BruteForce {
            return self.brute_force_impacts(state, q);
        }
        self.statistics.root_certified = self.method == Method::Certified
            && self.certificates.is_some_and(|certificates| self.norm < certificates.root_radius());
        if self.statistics.root_certified && self.exceptions().is_empty() {
            return Ok(());
        }
        state.boxes.update(self.model, &self.hierarchy, q, reach);
        for &pair in self.exceptions() {
            let faces = [pair.0, pair.1].map(|t| self.model.mesh().faces()[t as usize]);
            faces.iter().flatten().for_each(|&v| state.boxes.move_vertex(self.model, v, q));
            self.test_impact(state, pair);
        }
        if self.statistics.root_certified { Ok(()) } else { self.traverse_swept(state, q) }
    }

    /// Adds the pair if it counts and meets. Its vertices must be current.
    fn test_impact(&mut self, state: &mut Continuous, (a, b): Pair) {
        // The same test for every method.
        let (a, b) = (a.min(b), a.max(b));
        let boxes = &state.boxes;
        let hulls = self.filter.hulls(a, b).map(|(x, y)| [boxes.corners(x), boxes.corners(y)]);
        let mut first: Option<f64> = None;
        for [x, y] in hulls {
            if x.swept_box_meets(&y) {
                self.statistics.triangle_tests += 1;
                let time = impact_triangle_triangle(&x, &y, Impact::TOLERANCE);
                first = [first, time].into_iter().flatten().reduce(f64::min);
            }
        }
        if let Some(time) = first
            && !self.filter.leaves_out(a, b)
        {
            state.impacts.push(Impact { pair: (a, b), time });
        }
    }
}
