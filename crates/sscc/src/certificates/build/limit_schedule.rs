//! The limits up to which the BVTT is built, one after the other, until the budget of the pair tree is used up.
//!
//! The number of node pairs below a limit is not known in advance, so each limit is extrapolated from its growth so far
//! (docs/notes/pair-tree.md#rise-of-the-limit).

use crate::model::rounding::to_f32_down;

/// The first limit, as a share of the global radius.
const FIRST_SHARE: f64 = 1.0 / 16.0;

/// If there is no room even for the first limit, the next one is smaller by this factor.
const RETRY_DIVISOR: f64 = 2.0;

/// In this case the last limit tried is this share of the global radius.
const LAST_SHARE: f64 = FIRST_SHARE / 32.0;

/// The next limit is at most the one before times this: farther away it is not known how the number of pairs grows.
const MAX_STEP: f64 = 4.0;

/// The next limit is at least the one before times this: smaller steps are not worth another round.
const MIN_STEP: f64 = 1.2;

/// The budget need not be used up to the last pair: room for one tenth more pairs is not worth another round. Limits are
/// estimated for one tenth too many pairs, which are dropped in the end.
const BUDGET_MARGIN: f64 = 1.1;

/// Limits beyond the global radius may use the budget divided by this (docs/notes/pair-tree.md#reach).
const REACH_DIVISOR: usize = 2;

/// The outer limit is this many times the last one.
const OUTER_FACTOR: f64 = 1.5;

/// The limit to try next, and the results of the limits before.
pub(super) struct LimitSchedule {
    global_radius: f64,
    farthest: f64,
    budget: usize,
    limit: f64,
    complete_below: f64,
    too_large: f64,
}

impl LimitSchedule {
    /// Creates a schedule up to the farthest radius for a budget in pairs. None if radii are out of the range of single
    /// precision, in which the tree stores them.
    pub(super) fn new(global_radius: f64, farthest: f64, budget: usize) -> Option<Self> {
        let limit = f64::from(to_f32_down(global_radius * FIRST_SHARE));
        let is_in_range = limit > 0.0 && global_radius <= f64::from(f32::MAX);
        is_in_range.then_some(Self {
            global_radius,
            farthest,
            budget,
            limit,
            complete_below: 0.0,
            too_large: f64::INFINITY,
        })
    }

    /// Returns the limit to try.
    pub(super) fn limit(&self) -> f64 {
        self.limit
    }

    /// Returns the largest limit for which there was room; 0 if there was none.
    pub(super) fn complete_below(&self) -> f64 {
        self.complete_below
    }

    /// Advances to the next limit. Returns false if there is none. `has_room` is whether there was room for this one;
    /// `count_below` returns the number of pairs with a lower bound below a radius.
    pub(super) fn advance(&mut self, has_room: bool, count_below: impl Fn(f64) -> usize) -> bool {
        *(if with_mutant!(has_room, RefusedInnerRoundComplete, true) {
            &mut self.complete_below
        } else {
            &mut self.too_large
        }) = self.limit;
        let (next, smallest) = if self.complete_below == 0.0 {
            (self.limit / RETRY_DIVISOR, self.global_radius * LAST_SHARE)
        } else {
            let Some(estimate) = self.estimate(count_below) else { return false };
            let next = if estimate < self.too_large { estimate } else { self.half_way() };
            (next, (self.complete_below * MIN_STEP).min(self.end()))
        };
        self.limit = next;
        next >= smallest
    }

    /// Returns the limit of the outer round, which follows the last limit for which there was room. `has_room` is whether the
    /// whole budget has room for the pairs below that last limit; without room a limit beyond the global radius would be lowered
    /// again.
    pub(super) fn outer_limit(&self, has_room: bool) -> f64 {
        let end = if has_room { self.end() } else { self.global_radius };
        let outer = (OUTER_FACTOR * self.complete_below).min(with_mutant!(
            end,
            OuterRoundEndsAtGlobalRadius,
            self.global_radius
        ));
        // The limit is a number of single precision: so a bound that was cut off there is not below it, and its pair is not
        // stored. With another limit the pair would be stored, with a valid radius: a few more entries, and the same answers.
        with_mutant!(f64::from(to_f32_down(outer)), OuterLimitInDouble, outer)
    }

    /// Returns the largest limit to try. The rounds up to the global radius are the same for any farthest radius.
    fn end(&self) -> f64 {
        if self.complete_below < self.global_radius { self.global_radius } else { self.farthest }
    }

    /// Returns the limit half way, in logarithms, to the limit for which there was no room.
    fn half_way(&self) -> f64 {
        f64::from(to_f32_down((self.complete_below * self.too_large).sqrt()))
    }

    /// Estimates the limit that just uses up the budget if the number of pairs grows as a power of the limit. None if the budget
    /// is used up, or the last limit was the largest one to try.
    fn estimate(&self, count_below: impl Fn(f64) -> usize) -> Option<f64> {
        let count_below = |radius: f64| count_below(radius).max(1) as f64;
        let (stored, at_half) = (count_below(self.complete_below), count_below(self.complete_below / 2.0));
        let is_beyond = self.complete_below >= self.global_radius;
        let budget = if is_beyond { self.budget / REACH_DIVISOR } else { self.budget };
        let room = budget as f64 / stored;
        if self.complete_below >= self.end() || room < BUDGET_MARGIN {
            return None;
        }
        let power = (stored / at_half).log2().max(1.0);
        let step = (BUDGET_MARGIN * room).powf(1.0 / power).min(MAX_STEP);
        let next = f64::from(to_f32_down(self.complete_below * step)).min(self.end());
        (next > self.complete_below).then_some(next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a schedule for a global radius of 1 and a farthest radius of 16, after one limit for which there was room.
    fn after(limit: f64) -> LimitSchedule {
        LimitSchedule { limit, complete_below: limit, ..LimitSchedule::new(1.0, 16.0, 1 << 20).unwrap() }
    }

    #[test]
    fn limits_stop_at_the_global_radius_before_they_pass_it() {
        // The number of pairs is proportional to the limit, and the budget is unlimited.
        let limits = |farthest: f64| {
            let mut schedule = LimitSchedule::new(1.0, farthest, usize::MAX).unwrap();
            let mut limits = vec![schedule.limit()];
            while schedule.advance(true, |radius| (1e3 * radius) as usize) {
                limits.push(schedule.limit());
            }
            limits
        };
        assert_eq!(limits(1.0), [0.0625, 0.25, 1.0]);
        assert_eq!(limits(2.5), [0.0625, 0.25, 1.0, 2.5]);
        assert_eq!(limits(40.0), [0.0625, 0.25, 1.0, 4.0, 16.0, 40.0]);
        let next = |limit: f64| {
            let mut schedule = after(limit);
            schedule.advance(true, |radius| (16.0 * radius) as usize).then(|| schedule.limit())
        };
        assert_eq!((next(0.5), next(1.0), next(16.0)), (Some(1.0), Some(4.0), None));
        // Half of the budget is used up beyond the global radius, not at it.
        let has_next = |limit: f64| after(limit).advance(true, |_| 600_000);
        assert!(has_next(0.5) && !has_next(1.0) && !has_next(2.0));
    }

    #[test]
    fn the_outer_round_passes_the_global_radius_only_from_there_and_with_room() {
        let outer = |limit: f64, has_room: bool| after(limit).outer_limit(has_room);
        assert_eq!((outer(0.5, true), outer(0.75, true), outer(0.5, false)), (0.75, 1.0, 0.75));
        assert_eq!((outer(1.0, true), outer(2.0, true), outer(12.0, true)), (1.5, 3.0, 16.0));
        assert!(outer(1.0, false) <= 1.0 && outer(2.0, false) <= 2.0);
    }

    #[test]
    fn a_refused_limit_is_not_reached() {
        let mut schedule = LimitSchedule::new(1.0, 16.0, usize::MAX).unwrap();
        let count_below = |radius: f64| (1e3 * radius) as usize;
        assert!(schedule.advance(false, count_below) && schedule.complete_below() == 0.0);
        assert!(schedule.advance(true, count_below));
        let reached = schedule.complete_below();
        assert!(reached > 0.0 && schedule.limit() > reached);
        schedule.advance(false, count_below);
        assert_eq!(schedule.complete_below(), reached);
    }

    #[test]
    fn a_refused_limit_is_approached_by_halves_and_not_for_ever() {
        let new = LimitSchedule::new(1.0, 16.0, usize::MAX).unwrap();
        let mut schedule = LimitSchedule { complete_below: 0.25, limit: 1.0, ..new };
        let next = |_| schedule.advance(false, |_| 1).then(|| schedule.limit());
        let tried: Vec<f64> = (0..9).map_while(next).collect();
        // The roots of 1/4 and 1/8; the next one is below 1.2 / 4.
        assert!(
            tried.len() == 2 && tried[0] == 0.5 && (tried[1] - 0.125_f64.sqrt()).abs() < 1e-6,
            "{tried:?}"
        );
    }
}
