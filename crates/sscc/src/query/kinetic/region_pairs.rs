//! The pairs that a region search found. A pair is safe until z has travelled its safe distance; an active pair is tested
//! in every step.
//!
//! Time here is the travelled distance of z, which is never shorter than the distance between two of its positions.

use std::collections::BinaryHeap;

use crate::Pair;
use crate::min_heap::MinHeapEntry;
use crate::model::rounding::ROUND_DOWN;

/// Maximum number of safe distances, beside 1024, that are kept from one region to the next, for each pair that a
/// search finds.
const MAX_REMEMBERED: usize = 8;

/// A pair that stays free until z has travelled as far as its key. Pairs are ordered by their keys, the smallest first, then by
/// their triangles.
pub(super) type SafePair = MinHeapEntry<Pair>;

/// All pairs that can collide in the region. All other pairs are free in the whole region.
#[derive(Clone, Debug, Default)]
pub(super) struct RegionPairs {
    /// The distance that z has travelled since the last jump, rounded up.
    pub(super) travelled: f64,
    /// The travelled distance at which the region ends; 0 if there is no region.
    end: f64,
    /// Queries that were answered in the region.
    pub(super) steps: u64,
    /// Pairs within their safe distance.
    pub(super) safe: BinaryHeap<SafePair>,
    /// Pairs that are tested in every step.
    pub(super) active: Vec<Pair>,
    /// Safe pairs that earlier searches found, sorted by pair: a search finds most pairs again.
    pub(super) remembered: Vec<SafePair>,
    /// Scratch: the safe pairs for the next search.
    next_remembered: Vec<SafePair>,
}

impl RegionPairs {
    /// Adds a step of z.
    pub(super) fn advance(&mut self, step: f64) {
        self.travelled = with_mutant!(up(self.travelled + step), TravelledToNearest, self.travelled + step);
    }

    /// Begins a region around the current z, which ends at the latest when z has travelled a distance.
    pub(super) fn begin_region(&mut self, distance: f64) {
        (self.end, self.steps) = (self.travelled_after(distance), 0);
    }

    /// Ends the region.
    pub(super) fn leave_region(&mut self) {
        self.end = 0.0;
    }

    /// Returns the travelled distance after a further `distance`, rounded down.
    fn travelled_after(&self, distance: f64) -> f64 {
        (self.travelled + distance * ROUND_DOWN) * ROUND_DOWN
    }

    /// Stores a pair with its safe distance; false if the distance vanishes in rounding.
    pub(super) fn store(&mut self, pair: Pair, distance: f64) -> bool {
        let until = self.travelled_after(distance);
        if until <= self.travelled {
            return false;
        }
        if with_mutant!(until < self.end, SafeDistancesEndless, false) {
            self.safe.push(SafePair::new(until, pair));
        } else if self.steps == 0 {
            self.next_remembered.push(SafePair::new(until, pair));
        }
        true
    }

    /// Removes and returns a pair whose safe distance is used up; `None` if there is no such pair.
    #[inline]
    pub(super) fn next_expired(&mut self) -> Option<Pair> {
        // Equality would be a proof here, too: the key was rounded down, the travelled distance up.
        let until = self.safe.peek()?.key;
        if with_mutant!(until > self.travelled, SafeDistanceReached, until >= self.travelled) {
            return None;
        }
        self.safe.pop().map(|safe| safe.order)
    }

    /// Ends a step.
    pub(super) fn end_step(&mut self) {
        if self.steps == 0 {
            std::mem::swap(&mut self.remembered, &mut self.next_remembered);
            self.remembered.sort_unstable_by_key(|safe| safe.order);
        }
        self.steps += 1;
    }

    /// Removes the region and all safe distances, after a jump of z.
    pub(super) fn forget(&mut self) {
        (self.travelled, self.end) = (0.0, 0.0);
        if with_mutant!(true, SafeDistancesSurviveJumps, false) {
            self.remembered.clear();
        }
    }

    /// Whether the travelled distance is less than that at which the region ends.
    pub(super) fn has_travel_left(&self) -> bool {
        // Equality would be a proof here, too: the end was rounded down, the travelled distance up.
        with_mutant!(self.travelled < self.end, TravelReached, self.travelled <= self.end)
    }

    /// Whether the region lasts for a straight step from here, and all safe pairs stay within their safe distances.
    pub(super) fn is_safe_for(&self, step: f64) -> bool {
        let travelled = with_mutant!(up(self.travelled + step), StepOfMotionForgotten, self.travelled);
        travelled < self.end && self.safe.peek().is_none_or(|pair| pair.key > travelled)
    }

    /// Whether there is a region.
    pub(super) fn has_region(&self) -> bool {
        self.end > 0.0
    }

    /// Takes the sorted pairs of a region search. Pushes to `pending` those that no remembered safe distance keeps
    /// separate throughout the region.
    pub(super) fn take(&mut self, found: &[Pair], pending: &mut Vec<Pair>) {
        self.safe.clear();
        self.active.clear();
        pending.clear();
        if self.remembered.len() > MAX_REMEMBERED * found.len() + 1024 {
            self.remembered.clear();
        }
        let mut remembered =
            self.remembered.iter().copied().filter(|safe| safe.key > self.travelled).peekable();
        self.next_remembered.clear();
        for pair in found {
            while let Some(earlier) = remembered.next_if(|safe| safe.order < *pair) {
                self.next_remembered.push(earlier);
            }
            match remembered.next_if(|safe| safe.order == *pair) {
                Some(safe) if with_mutant!(safe.key >= self.end, RememberedWithinRegion, true) => {
                    self.next_remembered.push(safe)
                }
                _ => pending.push(*pair),
            }
        }
        self.next_remembered.extend(remembered);
    }
}

/// Rounds a computed sum of two non-negative numbers up.
pub(super) fn up(sum: f64) -> f64 {
    sum * (1.0 + 4.0 * f64::EPSILON)
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;

    /// The travelled distance is compared with the sum of its steps in exact arithmetic.
    #[test]
    fn the_travelled_distance_is_never_short() {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        let (mut region_pairs, mut sum) = (RegionPairs::default(), exact(0.0));
        for i in 0..500 {
            let step = f64::from(i * i % 37 + 1).sqrt() * 0.1_f64.powi(i % 7);
            region_pairs.advance(step);
            sum += exact(step);
            assert!(exact(region_pairs.travelled) >= sum, "{i}");
        }
    }

    /// At most 1024 safe distances, and eight for each pair that a search finds, are remembered; it may find none.
    #[test]
    fn few_distances_are_remembered() {
        for (found, count, are_kept) in
            [(0, 1024, true), (0, 1025, false), (40, 1344, true), (40, 1345, false)]
        {
            let remembered = (0..count).map(|i| SafePair::new(9.0, (7, i))).collect();
            let mut region_pairs = RegionPairs { remembered, ..RegionPairs::default() };
            let (found, mut pending): (Vec<Pair>, _) = ((0..found).map(|i| (1, i)).collect(), vec![(3, 4)]);
            region_pairs.begin_region(1.0);
            region_pairs.take(&found, &mut pending);
            assert_eq!(pending, found);
            region_pairs.end_step();
            assert_eq!(region_pairs.remembered.len(), if are_kept { count as usize } else { 0 });
        }
    }

    #[test]
    fn pairs_expire_in_order_and_never_late() {
        let mut region_pairs = RegionPairs::default();
        let mut pending = Vec::new();
        region_pairs.begin_region(8.0);
        region_pairs.take(&[(0, 1), (0, 2), (0, 3), (0, 4), (0, 5)], &mut pending);
        assert_eq!(pending, [(0, 1), (0, 2), (0, 3), (0, 4), (0, 5)]);
        for (pair, margin) in pending.iter().zip([4.0, 2.0, 9.0, 100.0, 1e-300]) {
            region_pairs.store(*pair, margin);
        }
        // A distance that vanishes in rounding is not stored.
        region_pairs.advance(1.0);
        assert!(!region_pairs.store((0, 5), 1e-18) && !region_pairs.store((0, 5), 0.0));
        region_pairs.end_step();
        assert_eq!(region_pairs.next_expired(), Some((0, 5)));
        assert_eq!(region_pairs.next_expired(), None);
        region_pairs.advance(0.5);
        assert_eq!(region_pairs.next_expired(), None);
        // A safe distance that is used up exactly no longer holds.
        region_pairs.advance(0.5);
        assert_eq!(region_pairs.next_expired(), Some((0, 2)));
        region_pairs.advance(5.0);
        assert_eq!(region_pairs.next_expired(), Some((0, 1)));
        assert!(region_pairs.has_region() && region_pairs.has_travel_left());
        region_pairs.advance(1.0);
        assert!(!region_pairs.has_travel_left());
        // In the next region (8 to 12) one of the other pairs is safe throughout, and one only up to 9.
        region_pairs.leave_region();
        region_pairs.begin_region(4.0);
        region_pairs.take(&[(0, 2), (0, 3), (0, 4), (1, 2)], &mut pending);
        assert_eq!(pending, [(0, 2), (0, 3), (1, 2)]);
        pending.drain(..).for_each(|pair| assert!(region_pairs.store(pair, 50.0)));
        region_pairs.end_step();
        region_pairs.advance(3.0);
        region_pairs.begin_region(4.0);
        region_pairs.take(&[(0, 1), (0, 2), (0, 3), (0, 4), (1, 2)], &mut pending);
        assert_eq!(pending, [(0, 1)]);
        // After a jump no safe distance is left.
        region_pairs.forget();
        assert!(!region_pairs.has_region());
        region_pairs.begin_region(4.0);
        region_pairs.take(&[(0, 4)], &mut pending);
        assert_eq!(pending, [(0, 4)]);
    }

    /// The travelled distance at which a safe distance ends is compared with their sum in exact arithmetic.
    #[test]
    fn safe_distances_end_before_they_are_used_up() {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        for i in 0..600 {
            let travelled = if i % 3 == 0 { 0.0 } else { f64::from(i).sqrt() * 0.1_f64.powi(i % 7) };
            let distance = f64::from(i * i % 41 + 1).sqrt() * 0.1_f64.powi(i % 5);
            let region_pairs = RegionPairs { travelled, ..RegionPairs::default() };
            let until = region_pairs.travelled_after(distance);
            assert!(exact(until) < exact(travelled) + exact(distance), "{travelled} {distance}");
            assert!(until >= (travelled + distance) * (1.0 - 1e-14), "{travelled} {distance}");
        }
    }

    #[test]
    fn vanishing_distances_are_not_stored_after_a_jump_either() {
        let mut region_pairs = RegionPairs::default();
        region_pairs.begin_region(1.0);
        assert!(!region_pairs.store((0, 1), 0.0) && region_pairs.safe.is_empty());
    }

    /// A motion is safe only before the end of the region and within the safe distance of every pair.
    #[test]
    fn motions_end_within_all_safe_distances() {
        let mut region_pairs = RegionPairs::default();
        assert!(!region_pairs.is_safe_for(0.0));
        region_pairs.begin_region(4.0);
        assert!(region_pairs.is_safe_for(3.9) && !region_pairs.is_safe_for(4.1));
        assert!(region_pairs.store((0, 1), 3.0) && region_pairs.store((0, 2), 2.0));
        region_pairs.end_step();
        assert_eq!(region_pairs.steps, 1);
        assert!(region_pairs.is_safe_for(1.9) && !region_pairs.is_safe_for(2.1));
        region_pairs.advance(1.5);
        assert!(region_pairs.is_safe_for(0.4) && !region_pairs.is_safe_for(0.6));
        region_pairs.end_step();
        assert_eq!(region_pairs.steps, 2);
        region_pairs.leave_region();
        assert!(!region_pairs.has_region() && !region_pairs.is_safe_for(0.4));
    }
}
