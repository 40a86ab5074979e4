//! Chooses the size of the next region, and measures whether regions pay: whether they cost less than plain queries (those without
//! a region) at the same steps.

/// A region of fewer steps does not pay: its search costs two or three plain queries.
pub(super) const MIN_STEPS: f64 = 8.0;

/// The size of the first ball in units of `|z|`.
const FIRST_BALL: f64 = 1.0 / 32.0;
/// The size of the first capsule in units of `|z|`.
const FIRST_CAPSULE: f64 = 1.0 / 8.0;
/// The smallest size of a region in units of `|z|`.
const MIN_SHARE: f64 = FIRST_BALL / 1024.0;
/// The largest size of a ball in units of `|z|`.
pub(super) const MAX_BALL: f64 = 0.25;
/// The largest size of a capsule in units of `|z|`.
pub(super) const MAX_CAPSULE: f64 = 1.0;

/// The factor from one size to the next while sizes grow.
const GROWTH: f64 = 1.25;
/// The factor from one size to the next while sizes shrink.
const SHRINKAGE: f64 = 1.0 / 1.5;

/// A search may cost this share of the plain queries that it is expected to save, between [`LEAST_COST`] and [`MOST_COST`].
const LARGEST_SHARE: f64 = 0.25;

/// A search may always cost this many plain queries.
const LEAST_COST: u64 = 8;

/// A search may never cost more than this many plain queries.
const MOST_COST: u64 = 64;

/// The expected cost of a ball for each step, as a share of a plain query, where none was measured.
const UNKNOWN_COST_PER_STEP: f64 = 0.2;

/// A region that cost more than it saved delays the next one: by 2 queries for each plain query that it cost too much. After each
/// further such region the delay is doubled, up to 2 to this power.
const MAX_FAILURES: u32 = 5;

/// The longest pause, in queries. It is limited because the plain query with which a region is compared may be an unusual one.
const MAX_PAUSE: u64 = 4096;

/// The shape of regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RegionKind {
    /// A ball, for motions that bend.
    Ball,
    /// A capsule, for motions that are nearly straight.
    Capsule,
}

/// The sizes of the regions of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) struct SizeControl {
    /// The size of the next region, in units of `|z|`.
    pub(super) share: f64,
    /// The factor from this size to the one after it.
    factor: f64,
    /// The largest size.
    largest: f64,
    /// The cost of the last search for each unit of its share.
    rate: f64,
    /// Queries without a region before the next one of this kind.
    pub(super) pause: u64,
    /// Number of regions that cost more than they saved since the last one that did not.
    failures: u32,
    /// The cost of the last region for each of its steps; `None` after one that did not pay.
    cost_per_step: Option<f64>,
}

impl SizeControl {
    const fn new(share: f64, largest: f64) -> Self {
        Self {
            share,
            factor: GROWTH,
            largest,
            rate: f64::INFINITY,
            pause: 0,
            failures: 0,
            cost_per_step: None,
        }
    }
}

/// The size of regions, and whether they pay. Costs are in AABBs compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct RegionControl {
    pub(super) balls: SizeControl,
    pub(super) capsules: SizeControl,
    /// The kind of the last region.
    kind: RegionKind,
    /// Whether the last region was smaller than its chosen size.
    is_cut: bool,
    /// The cost of the last plain query.
    pub(super) plain_cost: u64,
    /// The cost of the last region with all its steps.
    pub(super) cost: u64,
    /// The last step within a motion.
    step: f64,
    /// Whether the last region paid, over enough steps. A few steps are no evidence, since the plain query with which they are
    /// compared may be old.
    pub(super) has_paid: bool,
}

impl RegionControl {
    pub(super) const FIRST: Self = Self {
        balls: SizeControl::new(FIRST_BALL, MAX_BALL),
        capsules: SizeControl::new(FIRST_CAPSULE, MAX_CAPSULE),
        kind: RegionKind::Ball,
        is_cut: false,
        plain_cost: 0,
        cost: 0,
        step: 0.0,
        has_paid: false,
    };

    /// Begins a search for a region of this kind. `is_cut`: it is smaller than its chosen size.
    pub(super) fn begin_search(&mut self, kind: RegionKind, is_cut: bool) {
        (self.kind, self.is_cut) = (kind, is_cut);
    }

    /// Returns the largest cost of a search for a region that is expected to last for `steps` steps.
    pub(super) fn largest_cost(&self, steps: f64) -> u64 {
        self.plain_cost.saturating_mul(((LARGEST_SHARE * steps) as u64).clamp(LEAST_COST, MOST_COST))
    }

    /// Whether a ball may cost less for each step than a capsule. Motions back and forth stay long in balls.
    pub(super) fn is_ball_better(&self) -> bool {
        let unknown = UNKNOWN_COST_PER_STEP * self.plain_cost as f64;
        self.balls.pause == 0
            && self.balls.cost_per_step.unwrap_or(unknown) < self.capsules.cost_per_step.unwrap_or(0.0)
    }

    fn sizes(&mut self) -> &mut SizeControl {
        match self.kind {
            RegionKind::Ball => &mut self.balls,
            RegionKind::Capsule => &mut self.capsules,
        }
    }

    /// Counts a query without a region.
    pub(super) fn count_pause(&mut self) {
        for sizes in [&mut self.balls, &mut self.capsules] {
            sizes.pause = sizes.pause.saturating_sub(1);
        }
    }

    /// Records a step within a motion.
    pub(super) fn record_step(&mut self, step: f64) {
        self.step = step;
    }

    /// Returns the expected length of the steps after a jump, once for each region that paid: the motion that begins there is
    /// often like the last one.
    pub(super) fn step_after_jump(&mut self) -> Option<f64> {
        std::mem::take(&mut self.has_paid).then_some(self.step)
    }

    /// Records a complete search. Sizes continue to grow or to shrink while the cost per size falls; otherwise the trend reverses.
    /// A region that was cut has no influence.
    pub(super) fn record_search(&mut self, cost: u64, share: f64) {
        if self.is_cut {
            return;
        }
        let sizes = self.sizes();
        let rate = cost as f64 / share;
        if rate > sizes.rate {
            sizes.factor = if sizes.factor > 1.0 { SHRINKAGE } else { GROWTH };
        }
        sizes.rate = rate;
        sizes.share = (share * sizes.factor).clamp(MIN_SHARE, sizes.largest);
    }

    /// Records a search that found more pairs than its limit.
    pub(super) fn record_overflow(&mut self, cost: u64, share: f64) {
        self.cost = cost;
        self.end_region(0);
        let sizes = self.sizes();
        (sizes.share, sizes.factor, sizes.rate) = ((share / 4.0).max(MIN_SHARE), SHRINKAGE, f64::INFINITY);
    }

    /// Records the end of a region after `steps` steps. A region that cost more than plain queries delays the next one of its
    /// kind in proportion.
    pub(super) fn end_region(&mut self, steps: u64) {
        let lost = self.cost.saturating_sub(steps.saturating_mul(self.plain_cost));
        let plain_cost = self.plain_cost.max(1);
        self.has_paid = lost == 0 && steps as f64 >= MIN_STEPS;
        let cost = self.cost;
        let sizes = self.sizes();
        sizes.cost_per_step = (lost == 0).then(|| cost as f64 / steps as f64);
        sizes.failures = if lost > 0 { (sizes.failures + 1).min(MAX_FAILURES) } else { 0 };
        sizes.pause = (lost.saturating_mul(1 << sizes.failures) / plain_cost).min(MAX_PAUSE);
        if lost > 0 {
            sizes.share = (sizes.share / 2.0).max(MIN_SHARE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_that_do_not_pay_shrink_and_pause() {
        let mut control = RegionControl { plain_cost: 100, cost: 1000, ..RegionControl::FIRST };
        control.begin_search(RegionKind::Ball, false);
        // It cost as much as six more plain queries; the first pause is twice as long.
        control.end_region(4);
        assert_eq!((control.balls.share, control.balls.pause), (FIRST_BALL / 2.0, 12));
        assert!(!control.has_paid);
        control.end_region(20);
        assert_eq!((control.balls.share, control.balls.pause), (FIRST_BALL / 2.0, 0));
        assert!(control.has_paid);
        assert_eq!(control.capsules.share, FIRST_CAPSULE);
    }

    #[test]
    fn sizes_follow_the_cost_of_each_unit() {
        let mut control = RegionControl { plain_cost: 100, ..RegionControl::FIRST };
        control.begin_search(RegionKind::Capsule, false);
        control.record_search(1000, 0.1);
        assert_eq!(control.capsules.share, 0.1 * GROWTH);
        // The cost of each unit falls, then rises, then falls again.
        control.record_search(1000, 0.2);
        assert_eq!(control.capsules.share, 0.2 * GROWTH);
        control.record_search(2000, 0.2);
        assert_eq!(control.capsules.share, 0.2 * SHRINKAGE);
        control.record_search(1000, 0.15);
        assert_eq!(control.capsules.share, 0.15 * SHRINKAGE);
        control.record_search(1500, 0.2);
        assert_eq!(control.capsules.share, 0.2 * GROWTH);
        control.record_search(1, 5.0);
        assert_eq!(control.capsules.share, MAX_CAPSULE);
        let before = control.capsules.share;
        control.begin_search(RegionKind::Capsule, true);
        control.record_search(5000, 0.01);
        assert_eq!(control.capsules.share, before, "a region that was cut");
        assert_eq!(control.balls.share, FIRST_BALL);
    }

    #[test]
    fn a_search_that_overflows_is_followed_by_a_smaller_one() {
        let mut control = RegionControl { plain_cost: 10, ..RegionControl::FIRST };
        control.begin_search(RegionKind::Ball, false);
        control.record_overflow(1000, 0.2);
        assert_eq!((control.balls.share, control.balls.pause), (0.05, 2 * 100));
        control.record_overflow(u64::MAX, MIN_SHARE);
        assert_eq!((control.balls.share, control.balls.pause), (MIN_SHARE, MAX_PAUSE));
        // The next search is larger only after one whose unit cost more.
        control.record_search(10, 0.01);
        assert_eq!(control.balls.share, 0.01 * SHRINKAGE);
    }

    #[test]
    fn searches_may_cost_a_share_of_what_they_save() {
        let control = RegionControl { plain_cost: 10, ..RegionControl::FIRST };
        let costs = [0.0, 32.0, 40.0, 256.0, 1e300, f64::INFINITY].map(|steps| control.largest_cost(steps));
        assert_eq!(costs, [80, 80, 100, 640, 640, 640]);
        let control = RegionControl { plain_cost: u64::MAX, ..RegionControl::FIRST };
        assert_eq!(control.largest_cost(0.0), u64::MAX);
    }

    #[test]
    fn a_ball_is_better_where_its_steps_cost_less() {
        let mut control = RegionControl { plain_cost: 100, cost: 400, ..RegionControl::FIRST };
        assert!(!control.is_ball_better(), "no capsule has cost anything yet");
        control.begin_search(RegionKind::Capsule, false);
        control.end_region(10);
        // A step in a capsule costs 40; that in a ball is unknown, a fifth of a plain query.
        assert!(control.is_ball_better());
        control.begin_search(RegionKind::Ball, false);
        control.cost = 500;
        control.end_region(10);
        assert!(!control.is_ball_better());
        control.cost = 300;
        control.end_region(10);
        assert!(control.is_ball_better());
        control.balls.pause = 1;
        assert!(!control.is_ball_better());
        control.count_pause();
        assert!(control.is_ball_better());
    }

    #[test]
    fn the_step_after_a_jump_is_expected_once() {
        let mut control = RegionControl { plain_cost: 100, cost: 100, ..RegionControl::FIRST };
        control.record_step(0.5);
        assert_eq!(control.step_after_jump(), None);
        control.end_region(MIN_STEPS as u64 - 1);
        assert_eq!(control.step_after_jump(), None, "too few steps");
        control.end_region(MIN_STEPS as u64);
        assert_eq!([control.step_after_jump(), control.step_after_jump()], [Some(0.5), None]);
    }
}
