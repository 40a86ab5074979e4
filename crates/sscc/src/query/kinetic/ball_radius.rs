//! How large the next ball is to be, and whether there is to be one.

use super::LEAST_STEPS;

/// The radius of a ball in units of `|z|`: at first, at the most, at the least, and from one to the next.
const SHARE: f64 = 1.0 / 32.0;
pub(crate) const MOST: f64 = 0.25;
const LEAST: f64 = SHARE / 1024.0;
const FACTOR: f64 = 1.5;

/// Plain queries after a ball that lost time, for each that it lost.
const SHY: u64 = 32;

/// How large balls are, and whether they pay. Costs are in boxes compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// The radius of the next ball, in units of `|z|`, and the factor to the one after it.
    pub(crate) share: f64,
    factor: f64,
    /// What the last plain query cost, and the last ball with all its steps.
    pub(crate) plain: u64,
    pub(crate) cost: u64,
    /// What searching in the last ball cost for each unit of its share.
    rate: f64,
    /// Plain queries until the next ball.
    pub(crate) pause: u64,
    /// The last step within a motion.
    step: f64,
    /// Whether the last ball paid, over so many steps that it was a motion. Few tell nothing: what a plain query cost,
    /// by which they are judged, may be long ago.
    pub(crate) has_paid: bool,
}

impl Pace {
    pub(crate) const FIRST: Self = Self {
        share: SHARE,
        factor: FACTOR,
        plain: 0,
        cost: 0,
        rate: f64::INFINITY,
        pause: 0,
        step: 0.0,
        has_paid: false,
    };

    /// A step within a motion.
    pub(crate) fn went(&mut self, step: f64) {
        self.step = step;
    }

    /// The length to expect of the steps after a jump, once for each ball that paid: another motion begins there, as a
    /// rule like the last one.
    pub(crate) fn after_jump(&mut self) -> Option<f64> {
        std::mem::take(&mut self.has_paid).then_some(self.step)
    }

    /// The next ball becomes larger, or smaller, as long as that makes balls cheaper for their size.
    pub(crate) fn searched(&mut self, cost: u64, share: f64) {
        let rate = cost as f64 / share;
        if rate > self.rate {
            self.factor = 1.0 / self.factor;
        }
        self.rate = rate;
        self.share = (share * self.factor).clamp(LEAST, MOST);
    }

    /// A ball that more can meet in than there is room for.
    pub(crate) fn too_much(&mut self, cost: u64, share: f64) {
        self.cost = cost;
        self.left(0);
        (self.share, self.factor, self.rate) = ((share / 4.0).max(LEAST), 1.0 / FACTOR, f64::INFINITY);
    }

    /// A ball has been left after so many steps. What it lost, if it did, is to be little beside what follows.
    pub(crate) fn left(&mut self, steps: u64) {
        let lost = self.cost.saturating_sub(steps.saturating_mul(self.plain));
        self.pause = SHY.saturating_mul(lost) / self.plain.max(1);
        self.has_paid = lost == 0 && steps as f64 >= LEAST_STEPS;
        if lost > 0 {
            self.share = (self.share / 2.0).max(LEAST);
        }
    }
}
