//! The limits up to which the BVTT is built, one after the other, until the budget of the pair tree is used up.
//!
//! The number of node pairs below a limit is not known in advance, so each limit is extrapolated from its growth so far
//! (docs/notes/2026-11-23-pair-tree-limits.md).

use crate::model::rounding::to_f32_down;

/// The first limit, as a share of the global radius.
const FIRST_SHARE: f64 = 1.0 / 16.0;

/// If there is no room even for the first limit, the next one is smaller by this factor ...
const RETRY_DIVISOR: f64 = 2.0;

/// ... and the last one tried is this share of the global radius.
const LAST_SHARE: f64 = FIRST_SHARE / 32.0;

/// The next limit is at most the one before times this: farther away it is not known how the number of pairs grows.
const MAX_STEP: f64 = 4.0;

/// And at least times this; smaller steps are not worth another round.
const MIN_STEP: f64 = 1.2;

/// The budget need not be used up to the last pair: room for one tenth more pairs is not worth another round. Limits
/// are estimated for one tenth too many, which are dropped in the end.
const BUDGET_MARGIN: f64 = 1.1;

/// Which limit to try next.
pub(super) struct LimitSchedule {
    global_radius: f64,
    farthest: f64,
    limit: f64,
    complete_below: f64,
    too_large: f64,
}

impl LimitSchedule {
    /// None if radii are out of the range of single precision, in which the tree stores them.
    pub(super) fn new(global_radius: f64, farthest: f64) -> Option<Self> {
        let limit = f64::from(to_f32_down(global_radius * FIRST_SHARE));
        let is_in_range = limit > 0.0 && global_radius <= f64::from(f32::MAX);
        is_in_range.then_some(Self {
            global_radius,
            farthest,
            limit,
            complete_below: 0.0,
            too_large: f64::INFINITY,
        })
    }

    /// The limit to try.
    pub(super) fn limit(&self) -> f64 {
        self.limit
    }

    /// The largest limit for which there was room; 0 if there was none.
    pub(super) fn complete_below(&self) -> f64 {
        self.complete_below
    }

    /// Goes on to the next limit; false if there is none. `has_room`: whether there was room for this one; `count_below`:
    /// how many pairs have a lower bound below a radius.
    pub(super) fn advance(
        &mut self,
        has_room: bool,
        budget: usize,
        count_below: impl Fn(f64) -> usize,
    ) -> bool {
        *(if has_room { &mut self.complete_below } else { &mut self.too_large }) = self.limit;
        let (next, smallest) = if self.complete_below == 0.0 {
            (self.limit / RETRY_DIVISOR, self.global_radius * LAST_SHARE)
        } else {
            let Some(estimate) = self.estimate(budget, count_below) else { return false };
            let next = if estimate < self.too_large { estimate } else { self.half_way() };
            (next, (self.complete_below * MIN_STEP).min(self.farthest))
        };
        self.limit = next;
        next >= smallest
    }

    /// Half way, in logarithms, to the limit for which there was no room.
    fn half_way(&self) -> f64 {
        f64::from(to_f32_down((self.complete_below * self.too_large).sqrt()))
    }

    /// A limit that should just use up the budget, as if the number of pairs grew as a power of the limit; none if the
    /// budget is used up.
    fn estimate(&self, budget: usize, count_below: impl Fn(f64) -> usize) -> Option<f64> {
        let count_below = |radius: f64| count_below(radius).max(1) as f64;
        let (stored, at_half) = (count_below(self.complete_below), count_below(self.complete_below / 2.0));
        let room = budget as f64 / stored;
        if self.complete_below >= self.farthest || room < BUDGET_MARGIN {
            return None;
        }
        let power = (stored / at_half).log2().max(1.0);
        let step = (BUDGET_MARGIN * room).powf(1.0 / power).min(MAX_STEP);
        let next = f64::from(to_f32_down(self.complete_below * step)).min(self.farthest);
        (next > self.complete_below).then_some(next)
    }
}
