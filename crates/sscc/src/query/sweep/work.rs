//! The work of a sweep. It is counted, and its limit depends on the number of triangles alone, so that the answer is the same on
//! every machine.

use crate::detect::answer::Statistics;

/// The largest number of intervals; each takes one swept search. A sweep without grazing contacts takes a few.
const INTERVALS: usize = 4096;

/// An interval has at most this many candidates for each triangle of the mesh, and [`MIN_CANDIDATES`] more.
const CANDIDATES: usize = 2;
const MIN_CANDIDATES: usize = 4096;

/// The largest work is this for each triangle, and [`MIN_WORK`] more. The unit is the work of finding one candidate. Two layers that
/// nearly touch everywhere and rotate need a quarter of it (docs/notes/queries.md#sweeps-of-near-layers).
const WORK: usize = 1 << 15;
const MIN_WORK: usize = 1 << 21;

/// The work of advancing a candidate by a few rounded directions.
const ADVANCE: usize = 8;

/// The work of a step along features, which is also that of a candidate for which rounded directions do not suffice.
const FEATURE_STEP: usize = 128;

/// The largest number of steps along features of one candidate in one interval: more than any narrow pair needs that can be passed
/// (docs/notes/exact-tests.md#steps-of-conservative-advancement).
const FEATURE_STEPS: usize = 256;

/// The work that a sweep has done, and the work that it may still do.
pub(super) struct Work {
    /// The largest number of candidates of the next interval.
    pub(super) candidates: usize,
    intervals: usize,
    left: usize,
    total: Statistics,
}

impl Work {
    pub(super) fn of_mesh(triangles: usize) -> Self {
        Self {
            candidates: CANDIDATES.saturating_mul(triangles).saturating_add(MIN_CANDIDATES),
            intervals: INTERVALS,
            left: WORK.saturating_mul(triangles).saturating_add(MIN_WORK),
            total: Statistics::default(),
        }
    }

    /// Counts an interval. False if no other interval may begin.
    pub(super) fn begin_interval(&mut self) -> bool {
        let is_left = self.intervals > 0 && self.left > 0;
        self.intervals = self.intervals.saturating_sub(1);
        is_left
    }

    /// Counts the search of an interval that found `found` candidates.
    pub(super) fn add_search(&mut self, search: &Statistics, found: usize) {
        self.total.opened += search.opened;
        self.total.box_tests += search.box_tests;
        self.left = self.left.saturating_sub(found);
    }

    /// Returns the number of steps along features that the next candidate may take.
    pub(super) fn feature_steps(&self) -> usize {
        FEATURE_STEPS.min(self.left / FEATURE_STEP)
    }

    /// Counts the advancement of a candidate with `feature_steps` steps along features.
    pub(super) fn add_advance(&mut self, feature_steps: usize) {
        self.total.triangle_tests += 1 + feature_steps as u64;
        self.left = self.left.saturating_sub(ADVANCE + FEATURE_STEP * feature_steps);
    }

    /// Returns the cost of all intervals so far.
    pub(super) fn statistics(&self) -> Statistics {
        self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::Scope;
    use crate::test_models::{Random, strips};
    use crate::{Method, Query, SweepOutcome};

    /// The weight up to which the shape is proven free is at most that with a larger limit, and brute force finds no collision up to it.
    #[test]
    fn limited_sweeps_end_at_a_weight_up_to_which_the_shape_is_free() {
        let random = &mut Random(51);
        let (mut limited, mut part) = (0, 0);
        for case in 0..40 {
            let (model, _) = strips(random, case);
            let query = |method| Query::without_certificates(&model, Scope::of(&model), method).unwrap();
            let (mut query, mut oracle) = (query(Method::BdTree), query(Method::BruteForce));
            let q = vec![0.0; model.rank()];
            let to = 2.0 * model.weight_limits()[0];
            let whole = query.sweep(&q, 0, to).unwrap();
            let Some(whole_free) = whole.first_free else { continue };
            for left in [0, 1, 8, 64, 512, 4096] {
                for (intervals, candidates) in [(0, 9), (1, 9), (2, 1), (8, 1), (20, 2), (60, 2)] {
                    let work = Work { left, intervals, candidates, ..Work::of_mesh(1000) };
                    let sweep = query.sweep_within(&q, 0, to, work).unwrap();
                    assert!(intervals > 0 && left > 0 || sweep.first_free == Some(0.0), "{sweep:?}");
                    if sweep.outcome != SweepOutcome::StepLimit {
                        continue;
                    }
                    limited += 1;
                    let free = sweep.first_free.unwrap();
                    assert!(free <= whole_free + 1e-8 * to, "{sweep:?} {whole:?}");
                    part += i32::from(free > 0.0);
                    let mut at = q.clone();
                    for i in 0..=20 {
                        at[0] = free * f64::from(i) / 20.0;
                        assert!(oracle.discrete(&at).unwrap().is_empty(), "{sweep:?}");
                    }
                    at[0] = sweep.first_hit.unwrap_or(0.0);
                    assert_eq!(oracle.discrete(&at).unwrap(), sweep.pairs, "{sweep:?}");
                }
            }
        }
        assert!(limited > 100 && part > 5, "{limited} {part}");
    }

    #[test]
    fn counted_work_is_subtracted_down_to_0() {
        let mut work = Work { left: FEATURE_STEP * 3 + 5, intervals: 2, ..Work::of_mesh(0) };
        assert_eq!((work.candidates, work.feature_steps()), (MIN_CANDIDATES, 3));
        assert!(work.begin_interval());
        work.add_search(&Statistics { opened: 2, box_tests: 7, ..Statistics::default() }, 4);
        work.add_advance(2);
        assert_eq!((work.left, work.feature_steps()), (FEATURE_STEP - ADVANCE + 1, 0));
        assert!(work.begin_interval() && !work.begin_interval());
        work.add_advance(1);
        assert_eq!(work.left, 0);
        let total = work.statistics();
        assert_eq!((total.opened, total.box_tests, total.triangle_tests), (2, 7, 5));
        assert_eq!(Work::of_mesh(usize::MAX).left, usize::MAX);
    }
}
