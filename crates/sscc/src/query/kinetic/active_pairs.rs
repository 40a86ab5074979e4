//! What stands.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::up;
use crate::Pair;
use crate::model::rounding::ROUND_DOWN;

/// Pairs whose margins are remembered, for each that a search finds.
const MOST_KNOWN: usize = 8;

/// All pairs that can meet in the ball; the margins of the others are larger.
///
/// Places of z are told by the way that it has gone, which is never shorter than a distance between two of them.
#[derive(Debug, Default)]
pub(crate) struct Front {
    /// The way that z has gone since the last jump, rounded up.
    pub(crate) way: f64,
    /// The way at which the ball may be left; 0: there is none.
    end: f64,
    /// An upper bound of the reach of the shape in the ball.
    reach: f64,
    /// Queries that it answered.
    pub(crate) steps: u64,
    /// Pairs that stay apart for a while.
    pub(crate) apart: BinaryHeap<Standing>,
    /// Pairs that are tested in every step.
    pub(crate) hot: Vec<Pair>,
    /// Margins of pairs that earlier searches found, sorted by pair, and scratch for them: most pairs are found again.
    pub(crate) known: Vec<Standing>,
    known_next: Vec<Standing>,
}

impl Front {
    /// Goes a step.
    pub(crate) fn go(&mut self, step: f64) {
        self.way = right_or!(up(self.way + step), WayToNearest, self.way + step);
    }

    /// Begins to stand: in a ball of this radius around where z is.
    pub(crate) fn begin(&mut self, radius: f64, reach: f64) {
        (self.end, self.reach, self.steps) = (self.after(radius), reach, 0);
    }

    /// No longer stands.
    pub(crate) fn end(&mut self) {
        self.end = 0.0;
    }

    /// The way at which z may be as far from here as that, rounded down.
    fn after(&self, distance: f64) -> f64 {
        (self.way + distance * ROUND_DOWN) * ROUND_DOWN
    }

    /// Keeps a pair that stays apart until z is so far from here; false where that is too near, after rounding.
    pub(crate) fn keep(&mut self, pair: Pair, margin: f64) -> bool {
        let until = self.after(margin);
        if until <= self.way {
            return false;
        }
        if until < self.end {
            self.apart.push(Standing { until, pair });
        } else if self.steps == 0 {
            self.known_next.push(Standing { until, pair });
        }
        true
    }

    /// A pair whose margin is used up, if there is one.
    #[inline]
    pub(crate) fn expired(&mut self) -> Option<Pair> {
        // Equality would be a proof here, too: `until` has been rounded down, the way up.
        let until = self.apart.peek()?.until;
        if right_or!(until > self.way, MarginReached, until >= self.way) {
            return None;
        }
        self.apart.pop().map(|standing| standing.pair)
    }

    /// A query has been answered.
    pub(crate) fn answered(&mut self) {
        if self.steps == 0 {
            std::mem::swap(&mut self.known, &mut self.known_next);
            self.known.sort_unstable_by_key(|known| known.pair);
        }
        self.steps += 1;
    }

    /// Forgets everything: z has jumped.
    pub(crate) fn jump(&mut self) {
        (self.way, self.end) = (0.0, 0.0);
        self.known.clear();
    }

    /// Whether z is in the ball, and the shape's reach as was granted.
    pub(crate) fn stands(&self, reach: f64) -> bool {
        self.way < self.end && reach <= self.reach
    }

    /// Whether there is a ball.
    pub(crate) fn has_begun(&self) -> bool {
        self.end > 0.0
    }

    /// Takes what a search found, sorted: gives those pairs to `work` that are not known to stay apart in the ball.
    pub(crate) fn take(&mut self, found: &[Pair], work: &mut Vec<Pair>) {
        self.apart.clear();
        self.hot.clear();
        work.clear();
        if self.known.len() > MOST_KNOWN * found.len() + 1024 {
            self.known.clear();
        }
        let mut known = self.known.iter().copied().filter(|known| known.until > self.way).peekable();
        self.known_next.clear();
        for pair in found {
            while let Some(earlier) = known.next_if(|known| known.pair < *pair) {
                self.known_next.push(earlier);
            }
            match known.next_if(|known| known.pair == *pair) {
                Some(known) if known.until >= self.end => self.known_next.push(known),
                _ => work.push(*pair),
            }
        }
        self.known_next.extend(known);
    }
}

/// Two triangles that stay apart until z has gone so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    pub(crate) until: f64,
    pub(crate) pair: Pair,
}

/// The first to fall is the largest; then by its triangles, so that every run goes the same way.
impl Ord for Standing {
    fn cmp(&self, other: &Self) -> Ordering {
        other.until.total_cmp(&self.until).then_with(|| other.pair.cmp(&self.pair))
    }
}

impl PartialOrd for Standing {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Standing {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Standing {}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;

    /// The way against the sum of its steps in exact arithmetic.
    #[test]
    fn the_way_is_never_short() {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        let (mut front, mut sum) = (Front::default(), exact(0.0));
        for i in 0..500 {
            let step = f64::from(i * i % 37 + 1).sqrt() * 0.1_f64.powi(i % 7);
            front.go(step);
            sum += exact(step);
            assert!(exact(front.way) >= sum, "{i}");
        }
    }

    #[test]
    fn pairs_fall_in_order_and_never_late() {
        let mut front = Front::default();
        let mut work = Vec::new();
        front.begin(8.0, 1.0);
        front.take(&[(0, 1), (0, 2), (0, 3), (0, 4), (0, 5)], &mut work);
        assert_eq!(work, [(0, 1), (0, 2), (0, 3), (0, 4), (0, 5)]);
        for (pair, margin) in work.iter().zip([4.0, 2.0, 9.0, 100.0, 1e-300]) {
            front.keep(*pair, margin);
        }
        // Of what rounding eats up, nothing stands.
        front.go(1.0);
        assert!(!front.keep((0, 5), 1e-18) && !front.keep((0, 5), 0.0));
        front.answered();
        assert_eq!(front.expired(), Some((0, 5)));
        assert_eq!(front.expired(), None);
        front.go(0.5);
        assert_eq!(front.expired(), None);
        // A margin used up exactly no longer holds.
        front.go(0.5);
        assert_eq!(front.expired(), Some((0, 2)));
        front.go(5.0);
        assert_eq!(front.expired(), Some((0, 1)));
        assert!(front.has_begun() && front.stands(1.0) && !front.stands(1.1));
        front.go(1.0);
        assert!(!front.stands(1.0));
        // In the next ball (8 to 12) one of the others is known to stay apart; one only up to 9.
        front.end();
        front.begin(4.0, 1.0);
        front.take(&[(0, 2), (0, 3), (0, 4), (1, 2)], &mut work);
        assert_eq!(work, [(0, 2), (0, 3), (1, 2)]);
        work.drain(..).for_each(|pair| assert!(front.keep(pair, 50.0)));
        front.answered();
        front.go(3.0);
        front.begin(4.0, 1.0);
        front.take(&[(0, 1), (0, 2), (0, 3), (0, 4), (1, 2)], &mut work);
        assert_eq!(work, [(0, 1)]);
        // After a jump nothing is known.
        front.jump();
        assert!(!front.has_begun());
        front.begin(4.0, 1.0);
        front.take(&[(0, 4)], &mut work);
        assert_eq!(work, [(0, 4)]);
    }
}
