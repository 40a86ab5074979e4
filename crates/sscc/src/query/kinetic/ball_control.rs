//! Chooses the radius of the next ball, and whether a ball pays.

/// A ball of fewer steps does not pay: its search costs two or three plain queries.
pub(super) const MIN_STEPS: f64 = 8.0;

/// The radius of a ball in units of `|z|`: at first, at most, at least, and the factor from one to the next.
const FIRST_SHARE: f64 = 1.0 / 32.0;
pub(super) const MAX_SHARE: f64 = 0.25;
const MIN_SHARE: f64 = FIRST_SHARE / 1024.0;
const FACTOR: f64 = 1.5;

/// Plain queries after a ball that did not pay, for each plain query that it cost more than it saved.
const PAUSE_FACTOR: u64 = 32;

/// The size of balls, and whether they pay. Costs are in boxes compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallControl {
    /// The radius of the next ball, in units of `|z|`, and the factor to the one after it.
    pub(super) share: f64,
    factor: f64,
    /// The cost of the last plain query, and of the last ball with all its steps.
    pub(super) plain_cost: u64,
    pub(super) cost: u64,
    /// The cost of the last ball search for each unit of its share.
    rate: f64,
    /// Plain queries until the next ball.
    pub(super) pause: u64,
    /// The last step within a motion.
    step: f64,
    /// Whether the last ball paid, over enough steps. A few steps prove nothing, since the plain query by which they are
    /// judged may be long ago.
    pub(super) has_paid: bool,
}

impl BallControl {
    pub(super) const FIRST: Self = Self {
        share: FIRST_SHARE,
        factor: FACTOR,
        plain_cost: 0,
        cost: 0,
        rate: f64::INFINITY,
        pause: 0,
        step: 0.0,
        has_paid: false,
    };

    /// Records a step within a motion.
    pub(super) fn record_step(&mut self, step: f64) {
        self.step = step;
    }

    /// The length to expect of the steps after a jump, once for each ball that paid: the motion that begins there is often
    /// like the last one.
    pub(super) fn step_after_jump(&mut self) -> Option<f64> {
        std::mem::take(&mut self.has_paid).then_some(self.step)
    }

    /// Records a complete ball search. Radii go on growing or shrinking while the cost per radius falls; else the trend
    /// reverses.
    pub(super) fn record_search(&mut self, cost: u64, share: f64) {
        let rate = cost as f64 / share;
        if rate > self.rate {
            self.factor = 1.0 / self.factor;
        }
        self.rate = rate;
        self.share = (share * self.factor).clamp(MIN_SHARE, MAX_SHARE);
    }

    /// Records a ball search that found more pairs than its limit.
    pub(super) fn record_overflow(&mut self, cost: u64, share: f64) {
        self.cost = cost;
        self.end_ball(0);
        (self.share, self.factor, self.rate) = ((share / 4.0).max(MIN_SHARE), 1.0 / FACTOR, f64::INFINITY);
    }

    /// Records the end of a ball after `steps` steps. A ball that cost more than plain queries delays the next one in
    /// proportion.
    pub(super) fn end_ball(&mut self, steps: u64) {
        let lost = self.cost.saturating_sub(steps.saturating_mul(self.plain_cost));
        self.pause = PAUSE_FACTOR.saturating_mul(lost) / self.plain_cost.max(1);
        self.has_paid = lost == 0 && steps as f64 >= MIN_STEPS;
        if lost > 0 {
            self.share = (self.share / 2.0).max(MIN_SHARE);
        }
    }
}
