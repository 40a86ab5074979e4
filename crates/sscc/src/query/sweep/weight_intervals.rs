//! The intervals of a mode's weight over which the shape collides, from samples, and sweeps from free samples to the first contact.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::sweep::{Sweep, SweepOutcome};
use super::sweep_modes::ModeRange;
use crate::geometry::penetration_triangle_triangle;
use crate::query::query::Query;
use crate::{CancelToken, Error, Pair, Progress, ReducedModel};

/// The weights of a mode, within a range, at which the shape collides.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightIntervals {
    /// The mode and its range.
    pub range: ModeRange,
    /// The samples, at equal distances from one end of the range to the other.
    pub samples: Vec<WeightSample>,
    /// The intervals, in ascending order. Outside of them, up to `free_until` and from `free_from` on, the shape is proven
    /// free. Between two intervals there is a free sample.
    pub intervals: Vec<WeightInterval>,
}

/// The collisions at one weight, exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WeightSample {
    /// The weight.
    pub weight: f64,
    /// Number of colliding pairs.
    pub pairs: usize,
    /// The largest penetration depth of a pair (model unit); 0 if no pair collides, or all only touch.
    pub depth: f64,
}

/// An interval of weights. The shape collides at every sample inside; between two samples it may be free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightInterval {
    /// Up to this weight the shape is proven free, from the interval before it or the end of the range; `None` if the
    /// interval begins at that end.
    pub free_until: Option<f64>,
    /// The first weight. If `is_exact`, the shape collides there; otherwise nothing is proven beyond the free weights.
    pub from: f64,
    /// The last weight; see `from`.
    pub to: f64,
    /// From this weight on the shape is proven free; `None` if the interval ends at the end of the range.
    pub free_from: Option<f64>,
    /// Whether the shape collides at `from` and at `to`, at a distance of at most 1e-9 of the range of a sweep from the free weights
    /// beside them.
    pub is_exact: bool,
    /// The deepest of the weights at which pairs were counted: the samples inside, both ends, and a collision that a sweep
    /// found beyond an end that is not exact. Among equal depths it is that with most pairs, then that of smallest weight.
    pub deepest: WeightSample,
    /// The largest number of pairs that collide at any of these weights.
    pub pairs: usize,
}

/// The smallest number of samples of a mode: both ends of its range.
const MIN_SAMPLES: usize = 2;

/// The largest number of samples of a mode.
const MAX_SAMPLES: usize = 1 << 20;

/// Returns the largest penetration depth (model unit) of these pairs of triangles of a model at q; 0 where they only touch.
///
/// # Panics
/// When the mesh has no such triangles.
pub fn largest_depth(model: &ReducedModel, q: &[f64], pairs: &[Pair]) -> f64 {
    let corners = |t: u32| model.mesh().faces()[t as usize].map(|v| model.position(v, q));
    let depth = |(a, b): &Pair| penetration_triangle_triangle(&corners(*a), &corners(*b));
    // Colliding pairs have a penetration, which is 0 where they touch.
    pairs.iter().filter_map(depth).map(|found| found.depth).fold(0.0, f64::max)
}

impl Query {
    /// Finds for each mode the intervals of its weight over which the shape collides, with all other weights as in q. It
    /// counts the pairs and their depth at `samples` weights of the range, and finds the ends of the intervals by sweeps
    /// ([`Query::sweep`]). The shape is proven free outside of the intervals, up to their `free_until` and from their
    /// `free_from` on. Threads and `progress` are as for [`Query::sweep_modes`].
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
        let steps = Steps { progress, done: AtomicUsize::new(0), total: ranges.len() * STEPS };
        self.map_sweeps(q, ranges, threads, &steps, |query, at, range| {
            query.intervals(at, range, samples, &steps)
        })
    }

    fn intervals(
        &mut self,
        q: &mut [f64],
        &range: &ModeRange,
        samples: usize,
        steps: &Steps<'_>,
    ) -> Result<WeightIntervals, Error> {
        let last = samples - 1;
        let weight = |i: usize| {
            let share = i as f64 / last as f64;
            if i == last { range.high } else { range.low + share * (range.high - range.low) }
        };
        let mut line = Line { query: self, q, mode: range.mode };
        let sample = |i: usize| {
            let sample = line.sample(weight(i))?;
            // All steps of a mode but the last one belong to the samples, whatever their number.
            let reached = |i: usize| i * (STEPS - 1) / samples;
            steps.add(reached(i + 1) - reached(i));
            Ok(sample)
        };
        let samples: Vec<WeightSample> = (0..samples).map(sample).collect::<Result<_, Error>>()?;
        let mut intervals = Vec::new();
        // All samples before this one are done; this sample is free, or it is the first one.
        let mut at = 0;
        while at < last {
            let start = samples[at];
            let begin = if start.pairs > 0 {
                End::OfRange(start)
            } else {
                let next = (at..samples.len()).find(|i| samples[*i].pairs > 0);
                if with_mutant!(false, IntervalsBySamples, next.is_none()) {
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
                // Sweeps from a free weight back to one that collides, or to one beyond which nothing is proven.
                Some(next) => {
                    let start = begin.free().unwrap_or(begin.sample().weight);
                    let from = samples[next].weight;
                    line.end(from, with_mutant!(start, IntervalsEndWhereTheyBegin, from))?
                }
                None => Some(End::OfRange(samples[last])),
            };
            let end = match end {
                Some(end) => end,
                // The sweep from the other side proves all weights free.
                None if !begin.is_exact() => {
                    at = next.unwrap_or(last);
                    continue;
                }
                None => begin,
            };
            intervals.push(interval([begin, end], &samples));
            let Some(next) = next else { break };
            at = next;
        }
        Ok(WeightIntervals { range, samples, intervals })
    }
}

/// Steps of progress of each mode: enough for the progress bar of a single mode, and few enough that reports take no
/// time.
const STEPS: usize = 64;

/// Counts the steps of all modes; the last one of a mode is reported at its end.
struct Steps<'p> {
    progress: &'p dyn Progress,
    done: AtomicUsize,
    total: usize,
}

impl Steps<'_> {
    fn add(&self, steps: usize) {
        if steps > 0 {
            self.progress.report(self.done.fetch_add(steps, Ordering::Relaxed) + steps, self.total);
        }
    }
}

impl Progress for Steps<'_> {
    /// Counts the last step of a mode.
    fn report(&self, _done: usize, _total: usize) {
        self.add(1);
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        self.progress.cancel_token()
    }
}

/// Returns the interval between two ends.
fn interval([begin, end]: [End; 2], samples: &[WeightSample]) -> WeightInterval {
    // Sweeps from both sides of a narrow interval each find a collision within their tolerance, which may be beyond the other one.
    let ends = [begin, end].map(|end| end.sample().weight);
    let (from, to) = (ends[0].min(ends[1]), with_mutant!(ends[0].max(ends[1]), IntervalsUnordered, ends[1]));
    let found = [begin, end].into_iter().filter_map(|end| end.found());
    let counted = samples.iter().copied().chain(found).filter(|sample| (from..=to).contains(&sample.weight));
    let deeper = |x: WeightSample, y: WeightSample| {
        let is_deeper = (y.depth, y.pairs, x.weight) > (x.depth, x.pairs, y.weight);
        if is_deeper { y } else { x }
    };
    WeightInterval {
        free_until: begin.free(),
        from,
        to,
        free_from: end.free(),
        is_exact: begin.is_exact() && end.is_exact(),
        pairs: counted.clone().map(|sample| sample.pairs).max().unwrap_or(0),
        deepest: counted.fold(*begin.sample(), deeper),
    }
}

/// One end of an interval.
#[derive(Clone, Copy)]
enum End {
    /// The end of the range, where the shape collides.
    OfRange(WeightSample),
    /// An end found by a sweep: proven free up to the weight, and colliding at the sample.
    Touch { free: f64, sample: WeightSample },
    /// An end found by a sweep that proved the shape free up to the weight of the sample, and could not decide the weights just
    /// beyond it; `hit` is a collision farther on, if the sweep found one.
    Undecided { sample: WeightSample, hit: Option<WeightSample> },
}

impl End {
    fn sample(&self) -> &WeightSample {
        match self {
            Self::OfRange(sample) | Self::Touch { sample, .. } | Self::Undecided { sample, .. } => sample,
        }
    }

    fn free(&self) -> Option<f64> {
        match self {
            Self::OfRange(_) => None,
            Self::Touch { free, .. } => Some(*free),
            Self::Undecided { sample, .. } => Some(sample.weight),
        }
    }

    /// Returns the sample at which the shape collides.
    fn found(&self) -> Option<WeightSample> {
        match self {
            Self::OfRange(sample) | Self::Touch { sample, .. } => Some(*sample),
            Self::Undecided { hit, .. } => *hit,
        }
    }

    fn is_exact(&self) -> bool {
        !matches!(self, Self::Undecided { .. })
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

    /// Returns the sample at a weight at which these pairs collide.
    fn measured(&mut self, weight: f64, pairs: &[Pair]) -> WeightSample {
        self.q[self.mode] = weight;
        let depth = largest_depth(&self.query.context.model, self.q, pairs);
        WeightSample { weight, pairs: pairs.len(), depth }
    }

    /// Sweeps from a free weight towards another one. `None` if all weights between them are free.
    fn end(&mut self, from: f64, to: f64) -> Result<Option<End>, Error> {
        self.q[self.mode] = from;
        let Sweep { first_free, first_hit, pairs, outcome, .. } = self.query.sweep(self.q, self.mode, to)?;
        let free = first_free.unwrap_or(from);
        Ok(match (outcome, first_hit) {
            (SweepOutcome::Free, _) => None,
            (SweepOutcome::Hit, Some(hit)) => Some(End::Touch { free, sample: self.measured(hit, &pairs) }),
            (outcome, hit) => {
                // Pairs of a grazing contact do not collide exactly.
                let hit = hit.filter(|_| outcome != SweepOutcome::WithinTolerance);
                let sample = WeightSample { weight: free, ..WeightSample::default() };
                Some(End::Undecided { sample, hit: hit.map(|hit| self.measured(hit, &pairs)) })
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn collisions_beyond_an_undecided_end_count_inside_the_interval() {
        let undecided = |weight: f64, hit: WeightSample| End::Undecided {
            sample: WeightSample { weight, ..WeightSample::default() },
            hit: Some(hit),
        };
        let deep = WeightSample { weight: 0.5, pairs: 3, depth: 2.0 };
        let touch = WeightSample { weight: 0.75, pairs: 1, depth: 0.0 };
        let end = End::Touch { free: 0.8, sample: touch };
        let found = interval([undecided(0.25, deep), end], &[touch]);
        assert_eq!((found.from, found.to, found.is_exact), (0.25, 0.75, false));
        assert_eq!((found.deepest, found.pairs), (deep, 3));
        assert_eq!((found.free_until, found.free_from), (Some(0.25), Some(0.8)));

        let outside = WeightSample { weight: 0.875, ..deep };
        let found = interval([undecided(0.25, outside), end], &[touch]);
        assert_eq!((found.pairs, found.deepest.depth), (1, 0.0));
    }
}
