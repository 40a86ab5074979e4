//! The sweep of one mode: how far its weight can go until the shape touches itself.
//!
//! A sweep advances by intervals of weights. The swept search lists the pairs of triangles that can meet in an interval:
//! certificates, AABBs and the separating-axis test cull the others. Each candidate is advanced by conservative
//! advancement up to the least weight that the others have left ([`free_until`]). So all weights up to the result are proven
//! free, without samples; `weight_line.rs` has the argument for the rounding of positions. An interval with too many
//! candidates is cut.
//!
//! Where a pair blocks the way, exact tests just beyond it find the hit. A pair that passes without a hit is left behind
//! by short intervals. A pair that cannot be left behind is within the continuous tolerance, or closer than positions are
//! rounded.

use super::sweep::{Sweep, SweepOutcome};
use super::weight_line::{WeightLine, forward, simplest_between, weight_before};
use crate::detect::Impact;
use crate::geometry::{free_until, nearest_to_origin};
use crate::query::query::Query;
use crate::query::swept_search::SweptSearch;
use crate::{Error, Pair};

/// `first_free` and `first_hit` are at most this share of the range apart (1e-9, less the rounding of weights).
const BRACKET: f64 = 0.999e-9;

/// Exact tests beyond a weight at which a pair blocks the way, at distances that halve.
const EXACT_TESTS: i32 = 24;

/// Intervals, at most. A sweep without grazing contacts takes a few.
const MAX_INTERVALS: usize = 4096;

/// Short intervals that a pair blocks before it counts as one that cannot be left behind.
const MAX_BLOCKED: usize = 64;

/// An interval has at most this many candidates for each triangle of the mesh, and [`MIN_CANDIDATES`] more ...
const CANDIDATES: usize = 2;
const MIN_CANDIDATES: usize = 4096;

/// ... and at most this many in the shortest intervals.
const MAX_CANDIDATES: usize = 1 << 22;

/// Candidates between two checks whether the sweep was cancelled.
const CANDIDATES_PER_CHECK: usize = 64;

/// A sweep that can prove no more looks for a collision at twice as many weights.
const PROBES: i32 = 32;

/// The result of one interval.
enum Step {
    /// All of it is free.
    Free,
    /// It is free up to this weight, from which on the pair blocks the way.
    Blocked(f64, Pair),
    /// It has too many candidates.
    TooMany,
}

impl Query<'_> {
    /// Sweeps the weight of a mode (from 0) from its value in q to `to`, with all others as in q: proves how far the shape is
    /// free, and finds the first hit. Answers are about the computed shape at every f64 weight. If the shape collides at q, the
    /// pairs of that collision are the result; to leave them out, let them be ignored pairs
    /// ([`CertifyOptions::ignore_rest`](crate::CertifyOptions::ignore_rest)).
    ///
    /// Usually takes as long as some continuous queries, and a limited number of them at most.
    ///
    /// # Errors
    /// When there is no such mode; as [`Query::discrete`], for q and for q with the weight `to`; when the range is wider than
    /// numbers go; when it was cancelled.
    ///
    /// ```
    /// use glam::DVec3;
    /// use sscc::{Certificates, CertifyOptions, Modes, Query, ReducedModel, SweepOutcome, TriMesh};
    ///
    /// # fn main() -> Result<(), sscc::Error> {
    /// // Two triangles one unit apart, and a mode that lowers the upper one.
    /// let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    /// let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
    /// let modes = Modes::from_matrix(6, 1, |row, _mode| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 })?;
    /// let model = ReducedModel::new(mesh, modes)?;
    /// let certificates = Certificates::compute(&model, &CertifyOptions::default(), &())?;
    /// let mut query = Query::new(&model, &certificates)?;
    ///
    /// let sweep = query.sweep(&[0.0], 0, 3.0)?;
    /// let (free, hit) = (sweep.first_free.unwrap(), sweep.first_hit.unwrap());
    /// assert!(free < 1.0 && hit >= 1.0 && hit - free < 3e-9);
    /// assert_eq!((sweep.pairs.as_slice(), sweep.outcome), (&[(0, 1)][..], SweepOutcome::Hit));
    /// assert_eq!(query.sweep(&[0.0], 0, -3.0)?.outcome, SweepOutcome::Free);
    /// # Ok(())
    /// # }
    /// ```
    pub fn sweep(&mut self, q: &[f64], mode: usize, to: f64) -> Result<Sweep, Error> {
        let model = self.context.model;
        let pairs = self.discrete(q)?.to_vec();
        let rank = model.rank();
        let from = *q.get(mode).ok_or(Error::ModeIndex { mode, rank })?;
        let mut line = WeightLine::new(model, q, mode);
        model.check_coordinates(line.at(to))?;
        let range = (to - from).abs();
        if !range.is_finite() {
            return Err(Error::Option { name: "the range of a sweep", value: range, wanted: "finite" });
        }
        let sweep =
            Sweep { mode, from, to, first_free: None, first_hit: None, pairs, outcome: SweepOutcome::Free };
        if !sweep.pairs.is_empty() {
            let outcome = SweepOutcome::CollidingAtStart;
            return Ok(Sweep { first_hit: Some(from), outcome, ..sweep });
        }
        WeightSweep { query: self, line, sweep, range, bracket: BRACKET * range }.run()
    }
}

/// A sweep that begins at a free weight.
struct WeightSweep<'s, 'a> {
    query: &'s mut Query<'a>,
    line: WeightLine<'a>,
    /// The result so far.
    sweep: Sweep,
    range: f64,
    bracket: f64,
}

impl WeightSweep<'_, '_> {
    fn run(mut self) -> Result<Sweep, Error> {
        let to = self.sweep.to;
        let mut limit = CANDIDATES * self.query.context.model.mesh().faces().len() + MIN_CANDIDATES;
        let (mut free, mut step, mut blocked) = (self.sweep.from, self.range, 0);
        for _ in 0..MAX_INTERVALS {
            self.sweep.first_free = Some(free);
            if free == to {
                return Ok(self.sweep);
            }
            let end = forward(free, step, to);
            match self.advance([free, end], limit)? {
                Step::Free => (free, step) = (end, step * 2.0),
                Step::TooMany if step > self.bracket => step = 0.25 * (end - free).abs(),
                Step::TooMany if limit < MAX_CANDIDATES => limit *= 4,
                Step::TooMany => break,
                Step::Blocked(at, pair) => {
                    self.sweep.first_free = Some(at);
                    if let Some(hit) = self.exact_hit(pair, at) {
                        self.sweep.pairs = self.query.discrete(self.line.at(hit))?.to_vec();
                        (self.sweep.first_hit, self.sweep.outcome) = (Some(hit), SweepOutcome::Hit);
                        return Ok(self.sweep);
                    }
                    blocked += usize::from(step <= self.bracket);
                    if step <= self.bracket && at == free || blocked > MAX_BLOCKED {
                        return self.close_contact(pair, at);
                    }
                    (free, step) = (at, self.bracket);
                }
            }
        }
        self.sweep.outcome = SweepOutcome::StepLimit;
        self.probe()
    }

    /// Proves as much of an interval of weights free as it can, from its start, which must be free.
    fn advance(&mut self, weights: [f64; 2], limit: usize) -> Result<Step, Error> {
        let Self { query, line, .. } = self;
        line.set(weights);
        let [q_t0, q_t1] = line.ends();
        let [t0, t1] = [query.measure(q_t0)?, query.measure(q_t1)?];
        query.norm = t0.norm.max(t1.norm);
        if query.context.is_proven_free(query.norm) {
            return Ok(Step::Free);
        }
        let search = query.candidates.get_or_insert_with(|| Box::new(SweptSearch::new(&query.context)));
        search.find(&query.context, [t0, t1], query.norm, limit, &mut query.statistics)?;
        if !query.statistics.complete {
            return Ok(Step::TooMany);
        }
        let slack = line.slack(t0.reach.max(t1.reach));
        let filter = &query.context.detect.filter;
        let [start, mut end] = weights;
        let mut blocking = None;
        for (i, &pair) in search.narrow.0.list.iter().enumerate() {
            if i.is_multiple_of(CANDIDATES_PER_CHECK) && query.context.detect.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            for simplices in filter.simplex_pairs(pair.0, pair.1) {
                let [a, b] = [simplices.a, simplices.b].map(|vertices| line.moving(vertices));
                if end == start || !a.is_swept_aabb_overlapping(&b) {
                    continue;
                }
                let t = free_until(&a, &b, slack);
                if t < 1.0 {
                    end = weight_before([start, end], t);
                    line.set([start, end]);
                    blocking = Some(pair);
                }
            }
        }
        Ok(blocking.map_or(Step::Free, |pair| Step::Blocked(end, pair)))
    }

    /// The first of some weights within the bracket beyond `at` at which the pair collides exactly.
    fn exact_hit(&mut self, pair: Pair, at: f64) -> Option<f64> {
        let filter = &self.query.context.detect.filter;
        let faces = [pair.0, pair.1].map(|t| filter.faces()[t as usize]);
        let to = self.sweep.to;
        // Shapes that pass through each other without overlap touch at one weight, which is often a simple number.
        let simplest = simplest_between(at, forward(at, self.bracket, to));
        // The first step is to the next f64.
        let steps = [0.0].into_iter().chain((0..EXACT_TESTS).rev().map(|n| self.bracket * 0.5_f64.powi(n)));
        let mut weights = std::iter::once(simplest).chain(steps.map(|step| forward(at, step, to)));
        weights.find(|&weight| {
            self.line.set([weight; 2]);
            let [a, b] = faces.map(|face| self.line.moving(face).t0);
            filter.collide(pair, &a, &b)
        })
    }

    /// The result where a pair blocks the way at `at`, and exact tests find no hit.
    fn close_contact(mut self, pair: Pair, at: f64) -> Result<Sweep, Error> {
        let end = forward(at, self.bracket, self.sweep.to);
        self.line.set([at, end]);
        let [q_t0, q_t1] = self.line.ends();
        let impacts = self.query.continuous(q_t0, q_t1)?;
        let time = impacts.iter().map(|impact| impact.time).reduce(f64::min);
        let mut pairs: Vec<Pair> = impacts.iter().map(|impact| impact.pair).collect();
        if pairs.is_empty() && self.is_within_tolerance(pair) {
            pairs.push(pair);
        }
        if pairs.is_empty() {
            self.sweep.outcome = SweepOutcome::TooClose(pair);
            return self.probe();
        }
        let hit = weight_before([at, end], time.unwrap_or(0.0));
        Ok(Sweep { first_hit: Some(hit), pairs, outcome: SweepOutcome::WithinTolerance, ..self.sweep })
    }

    /// Whether the triangles of a pair are, at the first end of the line, within the tolerance of continuous queries.
    fn is_within_tolerance(&self, pair: Pair) -> bool {
        let mut simplices = self.query.context.detect.filter.simplex_pairs(pair.0, pair.1);
        simplices.any(|simplices| {
            let [a, b] = [simplices.a, simplices.b].map(|vertices| self.line.moving(vertices).t0);
            let size = a.iter().chain(&b).map(|p| (*p - a[0]).abs().max_element()).fold(0.0, f64::max);
            let differences: [_; 9] = std::array::from_fn(|ij| (b[ij % 3] - a[ij / 3]) / size);
            nearest_to_origin(&differences).point.length() <= Impact::TOLERANCE
        })
    }

    /// Looks for a collision beyond the weight up to which the shape is proven free, at distances that double and at
    /// weights that divide the range evenly.
    fn probe(mut self) -> Result<Sweep, Error> {
        let Sweep { from, to, .. } = self.sweep;
        let free = self.sweep.first_free.unwrap_or(from);
        let doubling = (0..PROBES).map(|n| forward(free, self.range * 0.5_f64.powi(n), to));
        let even = (1..=PROBES).map(|n| from + (to - from) * (f64::from(n) / f64::from(PROBES)));
        let is_beyond = |w: &f64| *w != free && (*w > free) == (to > free);
        let mut weights: Vec<f64> = doubling.chain(even).filter(is_beyond).collect();
        weights.sort_by(|v, w| (v - free).abs().total_cmp(&(w - free).abs()));
        for weight in weights {
            let pairs = self.query.discrete(self.line.at(weight))?;
            if !pairs.is_empty() {
                (self.sweep.first_hit, self.sweep.pairs) = (Some(weight), pairs.to_vec());
                break;
            }
        }
        Ok(self.sweep)
    }
}
