//! `KineticQuery`: tests only active pairs while z stays in a region, searches a new region when z leaves it, and falls
//! back to an ordinary query where no region pays.

use std::fmt;
use std::sync::Arc;

use super::region::Region;
use super::region_control::{MAX_BALL, MAX_CAPSULE, MIN_STEPS, RegionControl, RegionKind};
use super::region_pairs::RegionPairs;
use super::region_search::RegionSearch;
use super::safe_distance::SafeDistances;
use super::step_history::StepHistory;
use crate::arithmetic::check_arithmetic;
use crate::detect::answer::Statistics;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::search::Counters;
use crate::model::{ScaledModel, check_scaled_modes};
use crate::query::capsule_motion::{CapsuleMotion, CapsuleRates};
use crate::query::configuration::Configuration;
use crate::query::configuration_search::{SweptSearch, motion};
use crate::query::query::Query;
use crate::{CancelToken, Certificates, Error, Impact, Pair, ReducedModel};

/// Safe distances of at least this many steps are worth storing; pairs with smaller ones are tested in every step.
const STEPS_WORTH_STORING: f64 = 8.0;

/// Steps between two attempts to find safe distances of the pairs that are tested in every step.
const RETRY_STEPS: u64 = 16;

/// Safe distances computed between two checks whether the query was cancelled.
const DISTANCES_PER_CHECK: u64 = 1024;

/// A search may find at most this many pairs for each triangle, and [`MAX_MORE_PAIRS`] more.
const MAX_PAIRS_PER_TRIANGLE: usize = 8;

/// Pairs that a search may find in addition to [`MAX_PAIRS_PER_TRIANGLE`].
const MAX_MORE_PAIRS: usize = 1024;

/// Pairs that a search may find in addition to those that its cost allows.
const CHEAP_PAIRS: usize = 64;

/// A motion is a jump where a step is longer than this share of `|z|`.
const MAX_STEP: f64 = 0.25;

/// The cost of opening a node, in AABBs compared.
const OPEN_COST: u64 = 50;
/// The cost of comparing two hulls, in AABBs compared.
const HULL_COST: u64 = 30;
/// The cost of computing the safe distance of two triangles, in AABBs compared.
const DISTANCE_COST: u64 = 150;
/// The cost of testing two triangles, in AABBs compared.
const TEST_COST: u64 = 20;
/// The cost of finding two triangles in a region, in AABBs compared.
const FIND_COST: u64 = 150;

/// Answers as a [`Query`] with certificates, for a q that changes little from query to query, as in a simulation. The answers
/// are the same for any sequence of q, but after a small step only the pairs that may have changed are tested. Queries at
/// unrelated q cost the same as those of a [`Query`]. A kinetic query takes three times as much memory.
///
/// ```
/// # use glam::DVec3;
/// use sscc::{Certificates, CertifyOptions, KineticQuery, Modes, ReducedModel, TriMesh};
///
/// # fn main() -> Result<(), sscc::Error> {
/// # let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
/// # let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
/// # let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
/// # let model = ReducedModel::new(mesh, modes)?;
/// # let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
/// // The second of two triangles, one unit apart, falls in steps of 1/16 and touches the first once.
/// let mut query = KineticQuery::new(&model, &certificates)?;
/// let mut touching = Vec::new();
/// for step in 0..32 {
///     if !query.discrete(&[f64::from(step) / 16.0])?.is_empty() {
///         touching.push(step);
///     }
/// }
/// assert_eq!(touching, [16]);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct KineticQuery {
    pub(in crate::query) query: Query,
    search: RegionSearch,
    rates: CapsuleRates,
    distances: SafeDistances,
    pub(super) region: Region,
    pub(super) region_pairs: RegionPairs,
    pub(super) control: RegionControl,
    /// The last steps of q where the root's certificate does not hold.
    history: StepHistory,
    /// The end of the last motion that a continuous query found free; empty if there was none.
    pub(super) free_q: Vec<f64>,
    /// The cost of the region's search, which is added to the cost of the first step in the region.
    region_counters: Counters,
    /// Scratch for differences of q.
    offset: Vec<f64>,
    /// Scratch: pairs whose safe distance is to be computed.
    pending: Vec<Pair>,
}

/// Shows the last answer only.
impl fmt::Debug for KineticQuery {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("KineticQuery").field("query", &self.query).finish_non_exhaustive()
    }
}

impl KineticQuery {
    /// Creates a query without a region.
    ///
    /// # Errors
    /// As [`Query::new`]; when the metric of the certificates does not fit the model.
    pub fn new(model: &ReducedModel, certificates: &Certificates) -> Result<Self, Error> {
        let mut query = Query::new(model, certificates)?;
        let scope = &certificates.parts().scope;
        // Ordinary queries use the metric only for radii, whose certificates have checked it. Safe distances are computed here.
        check_scaled_modes(model.mesh(), model.modes(), &scope.metric)?;
        let scaled = ScaledModel::new(model, &scope.metric, &scope.center);
        if let Some(locals) = &mut query.context.locals {
            Arc::make_mut(locals).add_region_rates(&scope.metric);
        }
        let layout = &query.context.detect.layout;
        Ok(Self {
            search: RegionSearch::new(&query.context),
            rates: CapsuleRates::new(&scaled, certificates.hierarchy(), layout),
            distances: SafeDistances::new(scaled),
            region: Region::new(model.rank()),
            region_pairs: RegionPairs::default(),
            control: RegionControl::FIRST,
            history: StepHistory::new(model.rank()),
            free_q: Vec::new(),
            region_counters: Counters::default(),
            offset: vec![0.0; model.rank()],
            pending: Vec::new(),
            query,
        })
    }

    /// Returns the same query, which checks regularly whether the token cancels it; with `None` it no longer checks.
    #[must_use]
    pub fn cancelled_by(mut self, token: impl Into<Option<CancelToken>>) -> Self {
        self.query = self.query.cancelled_by(token);
        self
    }

    /// Returns all colliding pairs at q, as [`Query::discrete`].
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.query.forget();
        let configuration = self.query.measure(q)?;
        self.query.norm = configuration.norm;
        if self.query.context.is_root_certified(configuration.norm) {
            self.query.find_pairs(configuration, usize::MAX)?;
        } else {
            self.find_beyond_root(configuration)?;
        }
        Ok(self.query.pairs())
    }

    /// Returns all pairs that collide between two configurations, as [`Query::continuous`]. Only the active pairs are
    /// tested if `q_t0` is the q of the last discrete query that the root's certificate did not answer, the region
    /// around it proves all other pairs free until `q_t1`, and there are no exceptions. In all other cases, and if an
    /// active pair collides, this is a plain continuous query. Only pairs that come as close as [`Impact::TOLERANCE`]
    /// without a contact can make a difference. Answers of [`KineticQuery::discrete`] do not depend on this query.
    ///
    /// # Errors
    /// As [`Query::discrete`], for start and end.
    pub fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.query.forget();
        self.free_q.clear();
        let ends = [self.query.measure(q_t0)?, self.query.measure(q_t1)?];
        let largest = ends[0].norm.max(ends[1].norm);
        self.query.norm = with_mutant!(largest, KineticSweptNormAtStart, ends[0].norm);
        if self.query.context.is_proven_free(self.query.norm) {
            self.query.statistics = Statistics::PROVEN_FREE;
            return Ok(&[]);
        }
        check_arithmetic()?;
        if self.is_free_within_region(ends)? {
            self.query.statistics.complete = true;
            return Ok(&[]);
        }
        self.query.continuous(q_t0, q_t1)?;
        let is_free = self.query.pairs().is_empty();
        if with_mutant!(is_free, FreeEndOfAnyMotion, true) {
            self.free_q.extend_from_slice(q_t1);
        }
        let Some(swept) = &self.query.swept else { return Ok(&[]) };
        // The cost of testing only the exceptions is no estimate of the cost of a plain query.
        if !self.query.statistics.root_certified {
            self.control.plain_cost = plain_cost(swept.counters());
        }
        Ok(if is_free { &[] } else { &swept.narrow.0.list })
    }

    /// Whether safe distances and tests of the active pairs prove all pairs free while every vertex moves on a straight line
    /// from its position at the last q to that at another one.
    ///
    /// # Errors
    /// When the query was cancelled.
    pub(super) fn is_free_within_region(&mut self, [t0, t1]: [Configuration<'_>; 2]) -> Result<bool, Error> {
        let context = &self.query.context;
        // No region contains exceptions.
        let has_exceptions = !context.detect.exceptions.is_empty();
        // Region and safe distances bound motions that start at the last q; they prove nothing about other starts.
        let is_start_known = with_mutant!(t0.q == self.history.last_q, MotionStartUnchecked, true);
        if !is_start_known || with_mutant!(has_exceptions, KineticExceptionsForgotten, false) {
            return Ok(false);
        }
        let step = context.scope.metric.norm_from(t1.q, t0.q, &mut self.offset);
        // The region is convex, and contains the start.
        let is_contained = self.region.contains(&context.scope.metric, t1);
        if !(self.region_pairs.is_safe_for(step) && with_mutant!(is_contained, MotionLeavesRegion, true)) {
            return Ok(false);
        }
        let active = &self.region_pairs.active;
        if with_mutant!(active.is_empty(), ActivePairsNotSwept, true) {
            return Ok(true);
        }
        let swept = self.query.swept.get_or_insert_with(|| Box::new(SweptSearch::new(context)));
        let motion = motion([t0, t1]);
        let mut search = swept.certified.broad.search(&context.detect, &motion, &mut swept.narrow, 1);
        for &(a, b) in active {
            let [a, b] = [a, b].map(|t| search.sides[0].triangle(t));
            search.test_triangles(a, b);
        }
        let result = search.end();
        self.query.statistics.set_counters(swept.counters());
        result?;
        Ok(swept.narrow.hits().list.is_empty())
    }

    /// Returns the pairs that the last query found.
    pub fn pairs(&self) -> &[Pair] {
        self.query.pairs()
    }

    /// Returns the cost of the last query.
    pub fn statistics(&self) -> Statistics {
        self.query.statistics()
    }

    fn find_beyond_root(&mut self, configuration: Configuration<'_>) -> Result<(), Error> {
        check_arithmetic()?;
        let Configuration { q, norm, .. } = configuration;
        let metric = &self.query.context.scope.metric;
        let mut step = self.history.distance(metric, q);
        let is_jump = !(step.is_finite() && step <= MAX_STEP * norm);
        self.history.record(q, is_jump);
        let had_region = self.region_pairs.has_region();
        if is_jump {
            self.region_pairs.forget()
        } else {
            self.region_pairs.advance(step)
        }
        if had_region {
            let is_contained = self.region.contains(metric, configuration);
            if !(self.region_pairs.has_travel_left() && with_mutant!(is_contained, RegionNeverLeft, true)) {
                self.region_pairs.leave_region();
                self.control.end_region(self.region_pairs.steps);
            }
        }
        if is_jump {
            step = self.control.step_after_jump().unwrap_or(step);
        } else {
            self.control.record_step(step);
        }
        if !self.region_pairs.has_region() && !self.begin_region(configuration, step, is_jump)? {
            if q == self.free_q {
                self.query.statistics.complete = true;
                return Ok(());
            }
            self.query.find_pairs(configuration, usize::MAX)?;
            self.control.plain_cost = plain_cost(self.query.discrete.counters());
            return Ok(());
        }
        // After an error no pair is proven free.
        self.find_active(configuration, step).inspect_err(|_| self.region_pairs.forget())
    }

    /// Sets a region that contains this z. False if no region would cost less than plain queries; then the region is invalid, as
    /// before the first search.
    fn choose_region(&mut self, start: Configuration<'_>, step: f64, is_jump: bool) -> bool {
        let context = &self.query.context;
        let metric = &context.scope.metric;
        let norm = start.norm;
        // Where the pair tree is complete, it should be complete in the whole region: beyond its limit a search takes longer.
        let limit = context.pair_tree_end(norm);
        let least = 2.0 * MIN_STEPS;
        let steps = (self.control.capsules.share * norm / step).max(least);
        let steps = self.history.straight_steps(metric, steps);
        if steps >= least && !self.control.is_ball_better() {
            if self.control.capsules.pause > 0 {
                return false;
            }
            let radius = self.history.predict(metric, steps, &mut self.region.end);
            let end = self.query.check.measure(context, &self.region.end).ok();
            if let Some(end) = end.map(|end| (end.norm, end.reach)) {
                self.region.set_capsule(metric, start, end, radius);
                if self.region.norm < limit && self.region.size() <= MAX_CAPSULE * norm {
                    self.control.begin_search(RegionKind::Capsule, false);
                    return true;
                }
            }
        }
        if self.control.balls.pause > 0 || !(is_jump || self.history.is_known()) {
            return false;
        }
        let mut radius = (self.control.balls.share * norm).max(least * step);
        let left = (limit - norm) * (1.0 - 1e-9);
        let is_cut = radius >= left && left > MIN_STEPS * step;
        if is_cut {
            radius = left;
        }
        if !(radius > 0.0 && radius.is_finite() && radius <= MAX_BALL * norm) {
            return false;
        }
        self.region.set_ball(start, radius);
        self.control.begin_search(RegionKind::Ball, is_cut);
        true
    }

    /// Searches a region around this z; false if no region would cost less than plain queries.
    fn begin_region(&mut self, start: Configuration<'_>, step: f64, is_jump: bool) -> Result<bool, Error> {
        let is_chosen = self.choose_region(start, step, is_jump);
        self.control.count_pause();
        if !is_chosen {
            return Ok(false);
        }
        let Region { reach, radius, .. } = self.region;
        let share = self.region.size() / start.norm;
        let norm = with_mutant!(self.region.norm, KineticRegionAtCenter, start.norm);
        self.distances.begin(norm);
        let context = &self.query.context;
        let most = MAX_PAIRS_PER_TRIANGLE * context.model.mesh().faces().len() + MAX_MORE_PAIRS;
        let worth = self.control.largest_cost(self.region.size() / step) / (DISTANCE_COST + FIND_COST);
        let worth = usize::try_from(worth).unwrap_or(usize::MAX).saturating_add(CHEAP_PAIRS);
        let limit = most.min(worth);
        let motion = CapsuleMotion::new(&self.rates, [&self.region.start, &self.region.end], radius, reach);
        let result = self.search.find(context, &motion, norm, limit);
        let found = &self.search.narrow.0.list;
        let counters = &self.search.certified.broad.state.counters;
        // The counters of a success are added to those of the first step.
        let is_complete = result.inspect_err(|_| self.query.statistics.set_counters(counters))?;
        let cost = node_cost(counters) + FIND_COST * found.len() as u64;
        if !is_complete {
            self.control.record_overflow(cost, share);
            return Ok(false);
        }
        self.region_pairs.begin_region(self.region.largest_travel());
        self.region_pairs.take(found, &mut self.pending);
        self.control.cost = cost;
        self.control.record_search(cost + DISTANCE_COST * self.pending.len() as u64, share);
        self.region_counters = Counters { triangle_tests: 0, ..*counters };
        Ok(true)
    }

    /// Tests the active pairs, after computing new safe distances for the pairs whose safe distance is used up.
    fn find_active(&mut self, configuration: Configuration<'_>, step: f64) -> Result<(), Error> {
        let Query { context, discrete, statistics, .. } = &mut self.query;
        let (context, region_pairs) = (&context.detect, &mut self.region_pairs);
        let (broad, narrow) = (&mut discrete.certified.broad, &mut discrete.narrow);
        let motion = motion([configuration]);
        let mut cost = 0;
        let mut search = broad.search(context, &motion, narrow, usize::MAX);
        search.state.counters = std::mem::take(&mut self.region_counters);
        with_mutant!(search.test_exceptions(), KineticExceptionsUntested, ());
        if region_pairs.steps.is_multiple_of(RETRY_STEPS) {
            self.pending.append(&mut region_pairs.active);
        }
        while let Some(pair) = self.pending.pop().or_else(|| region_pairs.next_expired()) {
            let [side] = &mut search.sides;
            let corners = [pair.0, pair.1].map(|t| {
                let vertices = side.triangle(t).vertices;
                side.move_corners(vertices);
                side.volumes.corners(vertices)[0]
            });
            let distance = self.distances.of_triangles(&context.filter, pair, corners);
            let is_short = distance < STEPS_WORTH_STORING * step;
            let is_stored = !is_short
                && with_mutant!(region_pairs.store(pair, distance), VanishingDistancesStored, {
                    region_pairs.store(pair, distance);
                    true
                });
            if !is_stored {
                region_pairs.active.push(pair);
            }
            cost += DISTANCE_COST;
            if cost.is_multiple_of(DISTANCES_PER_CHECK * DISTANCE_COST) {
                search.check_cancelled();
                if search.state.is_cancelled() {
                    let result = search.end();
                    statistics.set_counters(&broad.state.counters);
                    return result;
                }
            }
        }
        region_pairs.end_step();
        self.control.cost =
            self.control.cost.saturating_add(cost + TEST_COST * region_pairs.active.len() as u64);
        for &(a, b) in &region_pairs.active {
            let [x, y] = [a, b].map(|t| search.sides[0].triangle(t));
            search.test_triangles(x, y);
        }
        let result = search.end();
        statistics.set_counters(&broad.state.counters);
        result?;
        narrow.0.list.sort_unstable();
        statistics.complete = true;
        Ok(())
    }
}

/// Returns the cost of a plain query.
fn plain_cost(counters: &Counters) -> u64 {
    node_cost(counters) + TEST_COST * counters.triangle_tests
}

/// Returns the cost of all nodes that a search visited.
fn node_cost(counters: &Counters) -> u64 {
    counters.box_tests + OPEN_COST * counters.opened + HULL_COST * counters.hull_tests
}
