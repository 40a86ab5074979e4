//! Kinetic queries: what one query decided stands for the next ones, as long as q stays near.
//!
//! A search at one z, with the boxes and radii of all z in a ball around it, finds every pair that can meet anywhere in
//! the ball. Each of them then stands by a margin of its own: two triangles that are apart stay so until z has moved by
//! the gap over the rate at which it can close. While z stays in the ball a query looks only at the pairs whose margin
//! is used up, and at those that collide or nearly do.

mod active_pairs;
mod ball_radius;
mod safe_distance;

use super::{Query, Statistics};
use crate::detect::ball::Ball;
use crate::detect::search::Finder;
use crate::model::ScaledModel;
use crate::model::check_scaled_modes;
use crate::query::context::Ends;
use crate::{Certificates, Error, Pair, Progress, ReducedModel};
use active_pairs::Front;
use ball_radius::{MOST, Pace};
use safe_distance::Margins;

/// A ball of fewer steps does not pay: its search costs two or three plain ones.
const LEAST_STEPS: f64 = 8.0;

/// Margins of at least this many steps are worth keeping; triangles with less are tested in every step.
const LASTING: f64 = 8.0;

/// Steps between two looks at whether hot pairs have cooled down.
const COOLING: u64 = 16;

/// Margins measured between two looks at whether the query was cancelled.
const MARGINS: u64 = 1024;

/// Pairs that a search may find: so many for each triangle, and as many as are worth so many plain queries.
const MOST_FOUND: usize = 8;
const WORTH: u64 = 64;

/// What it costs to open a node, to measure the margin of two triangles, to test them, and to find them in a ball: in
/// boxes compared.
const OPEN: u64 = 50;
const MARGIN: u64 = 150;
const TEST: u64 = 20;
const FOUND: u64 = 10;

/// As [`Query`] by certificates, for a q that changes little from query to query, as in a simulation: the answers are
/// the same for any sequence of q, but after a small step only what may have changed is looked at. Unrelated q cost
/// what they cost a [`Query`]. Takes three times its memory.
pub struct KineticQuery<'a> {
    query: Query<'a>,
    /// Finds what can meet in the ball.
    near: Finder<Pair, 2>,
    ball: Ball,
    margins: Margins,
    front: Front,
    pace: Pace,
    /// The last q, at which the root's certificate did not do; empty if there was none.
    before: Vec<f64>,
    /// Scratch for differences of q, and for pairs.
    offset: Vec<f64>,
    work: Vec<Pair>,
}

impl<'a> KineticQuery<'a> {
    /// A query that has not been asked anything yet.
    ///
    /// # Errors
    /// When the certificates are of another model, or their metric does not fit it.
    pub fn new(model: &'a ReducedModel, certificates: &'a Certificates) -> Result<Self, Error> {
        let query = Query::new(model, certificates)?;
        let scope = &certificates.parts().scope;
        // Ordinary queries need nothing of the metric but radii that are right; margins are computed anew.
        check_scaled_modes(model.mesh(), model.modes(), &scope.metric)?;
        let scaled = ScaledModel::new(model, &scope.metric, &scope.center);
        let tables = &query.discrete.boxes.tables;
        Ok(Self {
            near: Finder::new(tables, query.asked.method),
            ball: Ball::new(&scaled, certificates.hierarchy(), tables),
            margins: Margins::new(scaled),
            front: Front::default(),
            pace: Pace::FIRST,
            before: Vec::new(),
            offset: vec![0.0; model.rank()],
            work: Vec::new(),
            query,
        })
    }

    /// The same query, which looks now and then whether it was cancelled. Nothing is reported.
    #[must_use]
    pub fn cancelled_by(mut self, progress: &'a dyn Progress) -> Self {
        self.query = self.query.cancelled_by(progress);
        self
    }

    /// All colliding pairs at q, as [`Query::discrete`].
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        let ends = self.query.begin([q], usize::MAX)?;
        if self.query.asked.root_certifies(ends.norm) {
            self.query.discrete.find(&self.query.asked, &ends)?;
        } else {
            self.answer(&ends)?;
        }
        Ok(self.query.pairs())
    }

    /// What the last query found.
    pub fn pairs(&self) -> &[Pair] {
        self.query.pairs()
    }

    /// What the last query cost.
    pub fn statistics(&self) -> Statistics {
        self.query.statistics()
    }

    /// `|z|` of the last query, as [`Query::norm`].
    pub fn norm(&self) -> f64 {
        self.query.norm()
    }

    fn answer(&mut self, ends: &Ends<'_, 1>) -> Result<(), Error> {
        let [q] = ends.q;
        let mut step = if self.before.is_empty() {
            f64::INFINITY
        } else {
            self.query.asked.scope.metric.norm_from(q, &self.before, &mut self.offset)
        };
        self.before.clear();
        self.before.extend_from_slice(q);
        let had_begun = self.front.has_begun();
        let goes_on = step <= MOST * ends.norm;
        if goes_on {
            self.front.go(step);
        } else {
            self.front.jump();
        }
        if had_begun && !self.front.stands(ends.reach) {
            self.front.end();
            self.pace.left(self.front.steps);
        }
        if goes_on {
            self.pace.went(step);
        } else {
            step = self.pace.after_jump().unwrap_or(step);
        }
        if !self.front.has_begun() && !self.begin_front(ends, step)? {
            self.query.discrete.find(&self.query.asked, ends)?;
            self.pace.plain = plain_cost(&self.query.statistics());
            return Ok(());
        }
        // What was not measured is forgotten with all the rest.
        self.step(ends, step).inspect_err(|_| self.front.jump())
    }

    /// Finds what can meet in a ball around this z; false where no ball would pay.
    fn begin_front(&mut self, ends: &Ends<'_, 1>, step: f64) -> Result<bool, Error> {
        let [q] = ends.q;
        if self.pace.pause > 0 {
            self.pace.pause -= 1;
            return Ok(false);
        }
        let asked = &self.query.asked;
        let mut radius = (self.pace.share * ends.norm).max(2.0 * LEAST_STEPS * step);
        // Where the pair tree is complete, it is to be so in the ball.
        let limit = asked.complete_pair_tree(ends.norm).map_or(f64::INFINITY, |tree| tree.limit());
        let left = (limit - ends.norm) * (1.0 - 1e-9);
        let is_cut = radius >= left && left > LEAST_STEPS * step;
        if is_cut {
            radius = left;
        }
        if !(radius > 0.0 && radius.is_finite() && radius <= MOST * ends.norm) {
            return Ok(false);
        }
        let norm = right_or!(up(ends.norm + radius), KineticBallAtCentre, ends.norm);
        let reach = 2.0 * ends.reach;
        self.ball.set(radius, reach, q.len());
        self.margins.within(norm);
        let most = MOST_FOUND * asked.model.mesh().faces().len();
        let worth = WORTH.saturating_mul(self.pace.plain) / (MARGIN + FOUND);
        self.near.begin(most.min(usize::try_from(worth).unwrap_or(usize::MAX)).saturating_add(1024));
        let around = Ends { q: [q, q], norm, reach, ball: Some(&self.ball), pose: None };
        self.near.boxes.update(&asked.hierarchy, &around);
        self.near.search_by_boxes(asked, &around);
        self.near.outcome()?;
        if self.near.is_full() {
            self.pace.too_much(search_cost(&self.near), radius / ends.norm);
            return Ok(false);
        }
        self.near.found.sort_unstable();
        self.front.begin(radius, reach);
        self.front.take(&self.near.found, &mut self.work);
        // What is to be measured is counted then.
        self.pace.cost = search_cost(&self.near);
        if !is_cut {
            self.pace.searched(self.pace.cost + MARGIN * self.work.len() as u64, radius / ends.norm);
        }
        self.query.discrete.statistics = Statistics { triangle_tests: 0, ..self.near.statistics };
        Ok(true)
    }

    /// Answers by the front.
    fn step(&mut self, ends: &Ends<'_, 1>, step: f64) -> Result<(), Error> {
        let (asked, finder, front) = (&self.query.asked, &mut self.query.discrete, &mut self.front);
        let mut cost = 0;
        finder.boxes.update(&asked.hierarchy, ends);
        finder.test_exceptions(asked, ends);
        if front.steps.is_multiple_of(COOLING) {
            self.work.append(&mut front.hot);
        }
        while let Some(pair) = self.work.pop().or_else(|| front.expired()) {
            let at = [pair.0, pair.1].map(|t| {
                let places = finder.boxes.moved(asked, t, ends);
                finder.boxes.corners(places)[0]
            });
            let margin = self.margins.triangles(&asked.filter, pair, at);
            if margin < LASTING * step || !front.keep(pair, margin) {
                front.hot.push(pair);
            }
            cost += MARGIN;
            if cost.is_multiple_of(MARGINS * MARGIN) {
                finder.look(asked);
                finder.outcome()?;
            }
        }
        front.answered();
        self.pace.cost = self.pace.cost.saturating_add(cost + TEST * front.hot.len() as u64);
        for &(a, b) in &front.hot {
            let [x, y] = [a, b].map(|t| finder.boxes.moved(asked, t, ends));
            finder.test(asked, (a, x), (b, y), ends);
        }
        finder.outcome()?;
        finder.found.sort_unstable();
        finder.statistics.complete = true;
        Ok(())
    }
}

/// What a plain query cost.
fn plain_cost(statistics: &Statistics) -> u64 {
    statistics.box_tests + OPEN * statistics.opened + TEST * statistics.triangle_tests
}

/// What a search for all that can meet in a ball cost.
fn search_cost(near: &Finder<Pair, 2>) -> u64 {
    near.statistics.box_tests + OPEN * near.statistics.opened + FOUND * near.found.len() as u64
}

/// A rounded sum of two numbers that are not negative, rounded up.
fn up(sum: f64) -> f64 {
    sum * (1.0 + 4.0 * f64::EPSILON)
}

#[cfg(test)]
pub(crate) mod tests;
