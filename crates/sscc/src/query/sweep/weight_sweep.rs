//! The sweep of one mode: how far its weight can change until the shape touches itself.
//!
//! A sweep advances by intervals of weights. The swept search lists the pairs of triangles that can meet in an interval:
//! certificates, AABBs and the separating-axis test cull the others. Each candidate is advanced by conservative
//! advancement up to the smallest weight that the candidates before it reached ([`free_until`]). So all weights up to the
//! result are proven free, without samples; `weight_line.rs` has the argument for the rounding of positions. An interval with
//! too many candidates is cut. Layers that nearly touch also need only one interval, because [`free_until`] follows the
//! closest features where rounded directions make little progress. The work of all intervals is limited ([`Work`]).
//!
//! If a pair is not proven free beyond a weight, it *blocks* the interval, and exact tests just beyond this weight find the
//! hit. If there is no hit, short intervals pass the pair. If they cannot pass it, the distance of the pair is within the
//! continuous tolerance, or smaller than the rounding of positions.

use super::sweep::{Sweep, SweepOutcome};
use super::weight_line::{WeightLine, forward, weight_before};
use super::work::Work;
use crate::geometry::free_until;
use crate::query::configuration_search::SweptSearch;
use crate::query::query::Query;
use crate::{Error, Pair};

/// `first_free` and `first_hit` are at most this share of the range apart (1e-9, less the rounding of weights).
const BRACKET: f64 = 0.999e-9;

/// After this many blocked intervals, the pair that blocks the next one counts as one that cannot be passed.
const MAX_BLOCKED: usize = 32;

/// Intervals grow by this factor, so that a few of them suffice after a pair was passed.
const GROWTH: f64 = 8.0;

/// After an interval had too many candidates, intervals grow by this factor.
const CAREFUL_GROWTH: f64 = 2.0;

/// The largest number of candidates of the shortest intervals.
const MAX_CANDIDATES: usize = 1 << 22;

/// Candidates between two checks whether the sweep was cancelled.
const CANDIDATES_PER_CHECK: usize = 64;

/// The result of one interval.
enum Step {
    /// The interval is free.
    Free,
    /// The interval is free up to this weight, from which on the pair is not proven free.
    Blocked(f64, Pair),
    /// The interval has too many candidates.
    TooMany,
}

impl Query {
    /// Sweeps the weight of a mode (counted from 0) from its value in q to `to`, with all other weights as in q: proves how far
    /// the shape is free, and finds the first hit. Answers hold for the computed shape at every f64 weight. If the shape
    /// collides at q, the result is the pairs of that collision; certificates with ignored pairs exclude them
    /// ([`CertifyOptions::ignore_rest`](crate::CertifyOptions::ignore_rest)).
    ///
    /// A sweep usually takes as long as some continuous queries, also where parts nearly touch everywhere. The work is limited:
    /// the candidates, steps and intervals of a sweep are counted, and if they reach a limit that depends on the number of
    /// triangles alone, the outcome is [`SweepOutcome::StepLimit`]. [`Query::statistics`] are those of the whole sweep: its
    /// triangle tests are the pairs advanced, once for each interval, and the steps that follow features.
    ///
    /// # Errors
    /// When there is no such mode; as [`Query::discrete`], for q and for q with the weight `to`; when the width of the range is
    /// not finite; when the sweep was cancelled.
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
        self.sweep_within(q, mode, to, Work::of_mesh(self.context.model.mesh().faces().len()))
    }

    /// Sweeps as [`Query::sweep`], with at most this work.
    pub(super) fn sweep_within(
        &mut self,
        q: &[f64],
        mode: usize,
        to: f64,
        work: Work,
    ) -> Result<Sweep, Error> {
        let sweep = self.sweep_from(q, mode, to, work);
        self.statistics.finish(sweep)
    }

    /// Sweeps from q, which may collide; the caller notes whether the sweep succeeded.
    fn sweep_from(&mut self, q: &[f64], mode: usize, to: f64, work: Work) -> Result<Sweep, Error> {
        let model = self.context.model.clone();
        let pairs = self.discrete(q)?.to_vec();
        let rank = model.rank();
        let from = *q.get(mode).ok_or(Error::ModeIndex { mode, rank })?;
        let mut line = WeightLine::new(&model, q, mode);
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
        let bracket = BRACKET * range;
        let mut sweep = WeightSweep { query: self, line, sweep, range, bracket, work };
        let result = sweep.run();
        let WeightSweep { query, sweep, work, .. } = sweep;
        query.statistics = work.statistics();
        result.map(|()| sweep)
    }
}

/// A sweep that begins at a free weight.
pub(super) struct WeightSweep<'s> {
    pub(super) query: &'s mut Query,
    pub(super) line: WeightLine,
    /// The result so far.
    pub(super) sweep: Sweep,
    pub(super) range: f64,
    pub(super) bracket: f64,
    work: Work,
}

impl WeightSweep<'_> {
    fn run(&mut self) -> Result<(), Error> {
        let to = self.sweep.to;
        let (mut free, mut step, mut growth, mut blocked) = (self.sweep.from, self.range, GROWTH, 0);
        loop {
            self.sweep.first_free = Some(free);
            if free == to {
                return Ok(());
            }
            if !self.work.begin_interval() {
                break;
            }
            let end = forward(free, step, to);
            match self.advance([free, end])? {
                Step::Free => (free, step) = (end, step * growth),
                Step::TooMany if step > self.bracket => {
                    (step, growth) = (0.25 * (end - free).abs(), CAREFUL_GROWTH);
                }
                Step::TooMany if self.work.candidates < MAX_CANDIDATES => self.work.candidates *= 4,
                Step::TooMany => break,
                Step::Blocked(at, pair) => {
                    self.sweep.first_free = Some(at);
                    if let Some(hit) = self.exact_hit(pair, at) {
                        self.sweep.pairs = self.query.discrete(self.line.at(hit))?.to_vec();
                        (self.sweep.first_hit, self.sweep.outcome) = (Some(hit), SweepOutcome::Hit);
                        return Ok(());
                    }
                    blocked += 1;
                    if step <= self.bracket && at == free || blocked > MAX_BLOCKED {
                        // Without steps along features the bound of a pair may be much too small.
                        if self.work.feature_steps() == 0 {
                            break;
                        }
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
    fn advance(&mut self, weights: [f64; 2]) -> Result<Step, Error> {
        let Self { query, line, work, .. } = self;
        line.set(weights);
        let [q_t0, q_t1] = line.ends();
        let [t0, t1] = [query.measure(q_t0)?, query.measure(q_t1)?];
        query.norm = with_mutant!(t0.norm.max(t1.norm), SweepNormAtStart, t0.norm);
        if query.context.is_proven_free(query.norm) {
            return Ok(Step::Free);
        }
        let search = query.candidates.get_or_insert_with(|| Box::new(SweptSearch::new(&query.context)));
        let limit = work.candidates;
        let found = search.find(&query.context, [t0, t1], query.norm, limit, &mut query.statistics);
        work.add_search(&query.statistics, search.narrow.0.list.len());
        found?;
        if with_mutant!(!query.statistics.complete, SweepCutOffIsFree, false) {
            return Ok(Step::TooMany);
        }
        let slack = line.slack([t0.reach, t1.reach]);
        let filter = &query.context.detect.filter;
        let [start, mut end] = weights;
        let mut blocking = None;
        for (i, &pair) in search.narrow.0.list.iter().enumerate() {
            if i.is_multiple_of(CANDIDATES_PER_CHECK) && query.context.detect.is_cancelled() {
                return Err(Error::Cancelled);
            }
            for simplices in filter.simplex_pairs(pair.0, pair.1) {
                let [a, b] = [simplices.a, simplices.b].map(|vertices| line.moving(vertices));
                if end == start || !a.is_swept_aabb_overlapping(&b) {
                    continue;
                }
                let steps = work.feature_steps();
                let mut steps_left = steps;
                let t = free_until(&a, &b, slack, &mut steps_left);
                work.add_advance(steps - steps_left);
                if t < 1.0 {
                    end = weight_before([start, end], t);
                    line.set([start, end]);
                    blocking = Some(pair);
                }
            }
        }
        Ok(blocking.map_or(Step::Free, |pair| Step::Blocked(end, pair)))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::certificates::Scope;
    use crate::{Method, Modes, ReducedModel, TriMesh};

    /// Returns a small triangle, which the mode moves, and large ones at these heights.
    fn plates(small: [DVec3; 3], displacement: DVec3, heights: &[f64]) -> ReducedModel {
        let plate = |z: f64| [[-4.0, -4.0], [4.0, -4.0], [0.0, 6.0]].map(|[x, y]| DVec3::new(x, y, z));
        let p: Vec<DVec3> = small.into_iter().chain(heights.iter().flat_map(|z| plate(*z))).collect();
        let faces = (0..p.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let modes = (0..p.len()).map(|v| if v < 3 { displacement } else { DVec3::ZERO }).collect();
        ReducedModel::new(TriMesh::new(p, faces).unwrap(), Modes::new(1, modes).unwrap()).unwrap()
    }

    fn query(model: &ReducedModel) -> Query {
        Query::without_certificates(model, Scope::of(model), Method::Traditional).unwrap()
    }

    /// Returns a sweep that has proven its first weight alone.
    fn begun(query: &mut Query, from: f64, to: f64) -> WeightSweep<'_> {
        let model = query.context.model.clone();
        let (range, work) = ((to - from).abs(), Work::of_mesh(model.mesh().faces().len()));
        let outcome = SweepOutcome::Free;
        let sweep =
            Sweep { mode: 0, from, to, first_free: Some(from), first_hit: None, pairs: Vec::new(), outcome };
        let line = WeightLine::new(&model, &[from], 0);
        WeightSweep { query, line, sweep, range, bracket: BRACKET * range, work }
    }

    #[test]
    fn probes_find_the_nearest_collision_within_the_range() {
        // It meets a plate over 1/16 before the plate's height. Probes are 1/8 apart.
        let small = [DVec3::ZERO, DVec3::X * 0.1, DVec3::new(0.0, 0.05, 0.0625)];
        for (from, to, heights, hit) in [
            (0.5, 4.5, &[1.65, 3.15][..], Some(1.625)),
            (-2.0, 2.0, &[-0.85, 1.15], Some(-0.875)),
            (8.0, 12.0, &[13.0, 16.0, 136.0], None),
        ] {
            let mut query = query(&plates(small, DVec3::Z, heights));
            let mut sweep = begun(&mut query, from, to);
            sweep.probe().unwrap();
            assert_eq!(sweep.sweep.first_hit, hit, "{from} {to}");
        }
    }

    #[test]
    fn pairs_within_the_tolerance_are_a_contact() {
        let within = (SweepOutcome::WithinTolerance, Some(0.25));
        let beyond = (SweepOutcome::TooClose((0, 1)), None);
        for (exponent, expected) in [(-38, within), (-36, beyond)] {
            let gap = DVec3::Z * 2.0_f64.powi(exponent);
            let small = [DVec3::ZERO, DVec3::X * 0.1, DVec3::Y * 0.05].map(|p| p + gap);
            let mut query = query(&plates(small, DVec3::X, &[0.0]));
            let mut sweep = begun(&mut query, 0.0, 1.0);
            sweep.close_contact((0, 1), 0.25).unwrap();
            assert_eq!((sweep.sweep.outcome, sweep.sweep.first_hit), expected);
        }
    }
}
