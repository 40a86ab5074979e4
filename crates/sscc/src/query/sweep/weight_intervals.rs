//! The intervals of a mode's weight over which the shape collides: samples, and sweeps from free samples to where it touches.

use super::sweep::{Sweep, SweepOutcome};
use super::sweep_modes::ModeRange;
use crate::geometry::penetration_triangle_triangle;
use crate::query::query::Query;
use crate::{Error, Pair, Progress};

/// Where over a range of its weight a mode lets the shape collide.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightIntervals {
    /// The mode and its range.
    pub range: ModeRange,
    /// The samples, at equal distances from one end of the range to the other.
    pub samples: Vec<WeightSample>,
    /// The intervals, in ascending order: outside of them, up to `free_until` and from `free_from` on, the shape is proven free. Two of
    /// them have a free sample between them.
    pub intervals: Vec<WeightInterval>,
}

/// How much collides at one weight: exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WeightSample {
    /// The weight.
    pub weight: f64,
    /// Number of colliding pairs.
    pub pairs: usize,
    /// The largest penetration depth of a pair (model unit); 0 where none collides, or all only touch.
    pub depth: f64,
}

/// An interval of weights. Every sample inside collides. Between samples it may be free, for weights closer together than those.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightInterval {
    /// Up to this weight the shape is proven free, from the interval before it or the end of the range; none: the
    /// interval begins at that end.
    pub free_until: Option<f64>,
    /// Its first and its last weight. Where `is_exact`, the shape collides there; else nothing is proven beyond the free weights.
    pub from: f64,
    /// See `from`.
    pub to: f64,
    /// From this weight on the shape is proven free; none: the interval ends at the end of the range.
    pub free_from: Option<f64>,
    /// Whether the shape collides at `from` and at `to`, at most 1e-9 of the way of a sweep from the free weights beside them.
    pub is_exact: bool,
    /// The deepest of the samples inside and of both ends; of equal ones that with most pairs, then the first.
    pub deepest: WeightSample,
    /// Most pairs that collide at any of these.
    pub pairs: usize,
}

/// The fewest samples: both ends.
pub(crate) const MIN_SAMPLES: usize = 2;

/// The most samples of a mode.
pub(crate) const MAX_SAMPLES: usize = 1 << 20;

impl Query {
    /// Finds for each mode the intervals of its weight over which the shape collides, with all others as in q: at so many
    /// samples of its range what collides and how deep, and by sweeps ([`Query::sweep`]) where it begins and ends. The shape is
    /// proven free outside of the intervals, up to their `free_until` and from their `free_from` on. Threads and `progress` as for [`Query::sweep_modes`].
    ///
    /// # Errors
    /// When there are fewer than 2 or more than 2^20 samples; as [`Query::sweep_modes`].
    pub fn sweep_intervals(
        &self,
        q: &[f64],
        ranges: &[ModeRange],
        samples: usize,
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<WeightIntervals>, Error> {
        if !(MIN_SAMPLES..=MAX_SAMPLES).contains(&samples) {
            let wanted = "from 2 to 2^20";
            return Err(Error::Option { name: "the number of samples", value: samples as f64, wanted });
        }
        self.context.model.check_coordinates(q)?;
        ranges.iter().try_for_each(|range| range.check(q).map(|_| ()))?;
        self.for_each_way(q, ranges, threads, progress, |query, at, range| {
            query.intervals(at, range, samples)
        })
    }

    fn intervals(
        &mut self,
        q: &mut [f64],
        &range: &ModeRange,
        samples: usize,
    ) -> Result<WeightIntervals, Error> {
        let last = samples - 1;
        let weight = |i: usize| {
            let share = i as f64 / last as f64;
            if i == last { range.high } else { range.low + share * (range.high - range.low) }
        };
        let mut line = Line { query: self, q, mode: range.mode };
        let samples: Vec<WeightSample> =
            (0..samples).map(|i| line.sample(weight(i))).collect::<Result<_, _>>()?;
        let mut intervals = Vec::new();
        // The samples before this one are done; it is free, or it is the first.
        let mut at = 0;
        while at < last {
            let start = samples[at];
            let begin = if start.pairs > 0 {
                End::OfRange(start)
            } else {
                let next = (at..samples.len()).find(|i| samples[*i].pairs > 0);
                if right_or!(false, IntervalsBySamples, next.is_none()) {
                    break;
                }
                let next = next.unwrap_or(last);
                match line.end(start.weight, samples[next].weight)? {
                    Some(end) => end,
                    None => break,
                }
            };
            let next = (at + 1..samples.len())
                .find(|i| samples[*i].pairs == 0 && samples[*i].weight > begin.sample().weight);
            let end = match next {
                // From a free weight back to one that collides, or to one beyond which nothing is proven.
                Some(next) => {
                    let start = begin.free().unwrap_or(begin.sample().weight);
                    let from = samples[next].weight;
                    line.end(from, right_or!(start, IntervalsEndWhereTheyBegin, from))?
                }
                None => Some(End::OfRange(samples[last])),
            };
            let end = match end {
                Some(end) => end,
                // From the other side all of it is proven free.
                None if !begin.is_exact() => {
                    at = next.unwrap_or(last);
                    continue;
                }
                None => begin,
            };
            let inside = samples
                .iter()
                .filter(|sample| (begin.sample().weight..=end.sample().weight).contains(&sample.weight));
            let all = || inside.clone().chain([begin.sample(), end.sample()]);
            let deeper = |x: WeightSample, y: &WeightSample| {
                if (y.depth, y.pairs) > (x.depth, x.pairs) { *y } else { x }
            };
            intervals.push(WeightInterval {
                free_until: begin.free(),
                from: begin.sample().weight,
                to: end.sample().weight,
                free_from: end.free(),
                is_exact: begin.is_exact() && end.is_exact(),
                deepest: all().fold(*begin.sample(), deeper),
                pairs: all().map(|sample| sample.pairs).max().unwrap_or(0),
            });
            let Some(next) = next else { break };
            at = next;
        }
        Ok(WeightIntervals { range, samples, intervals })
    }
}

/// One end of an interval.
#[derive(Clone, Copy)]
enum End {
    /// The end of the range, where the shape collides.
    OfRange(WeightSample),
    /// Found by a sweep: proven free up to the weight, and colliding at the sample.
    Touch { free: f64, sample: WeightSample },
    /// Found by a sweep that could not decide what is beyond the weight up to which it is free.
    Undecided(WeightSample),
}

impl End {
    fn sample(&self) -> &WeightSample {
        match self {
            Self::OfRange(sample) | Self::Touch { sample, .. } | Self::Undecided(sample) => sample,
        }
    }

    fn free(&self) -> Option<f64> {
        match self {
            Self::OfRange(_) => None,
            Self::Touch { free, .. } => Some(*free),
            Self::Undecided(sample) => Some(sample.weight),
        }
    }

    fn is_exact(&self) -> bool {
        !matches!(self, Self::Undecided(_))
    }
}

/// The configurations in which the weight of one mode varies.
struct Line<'l> {
    query: &'l mut Query,
    q: &'l mut [f64],
    mode: usize,
}

impl Line<'_> {
    fn sample(&mut self, weight: f64) -> Result<WeightSample, Error> {
        self.q[self.mode] = weight;
        let pairs = self.query.discrete(self.q)?.to_vec();
        Ok(self.measured(weight, &pairs))
    }

    /// The sample at a weight at which these pairs collide.
    fn measured(&mut self, weight: f64, pairs: &[Pair]) -> WeightSample {
        self.q[self.mode] = weight;
        let model = &self.query.context.model;
        let corners = |t: u32| model.mesh().faces()[t as usize].map(|v| model.position(v, self.q));
        // A pair of which only a common vertex and more touches has no depth.
        let depth = |(a, b): &Pair| {
            penetration_triangle_triangle(&corners(*a), &corners(*b)).map_or(0.0, |found| found.depth)
        };
        WeightSample { weight, pairs: pairs.len(), depth: pairs.iter().map(depth).fold(0.0, f64::max) }
    }

    /// Sweeps from a free weight towards another one. None: all of it is free.
    fn end(&mut self, from: f64, to: f64) -> Result<Option<End>, Error> {
        self.q[self.mode] = from;
        let Sweep { first_free, first_hit, pairs, outcome, .. } = self.query.sweep(self.q, self.mode, to)?;
        let free = first_free.unwrap_or(from);
        Ok(match (outcome, first_hit) {
            (SweepOutcome::Free, _) => None,
            (SweepOutcome::Hit, Some(hit)) => Some(End::Touch { free, sample: self.measured(hit, &pairs) }),
            _ => Some(End::Undecided(WeightSample { weight: free, ..WeightSample::default() })),
        })
    }
}
