//! Exceptions: pairs that no radius speaks of, tested exactly in every query, whatever else is skipped.

use crate::detect::narrow_phase::Found;
use crate::detect::search::Finder;
use crate::geometry::Aabb;
use crate::query::context::{Asked, Ends};

/// Boxes compared between two looks at whether the query was cancelled.
const BOXES: u64 = 1024;

impl<F: Found<E>, const E: usize> Finder<F, E> {
    /// Adds the exceptions that count.
    pub(crate) fn test_exceptions(&mut self, asked: &Asked<'_>, ends: &Ends<'_, E>) {
        for &pair in right_or!(asked.exceptions(), ExceptionsForgotten, &[]) {
            if self.is_full() {
                return;
            }
            let [x, y] = [pair.0, pair.1].map(|t| {
                let places = self.boxes.moved(asked, t, ends);
                self.boxes.corners(places)
            });
            self.statistics.box_tests += 1;
            if self.statistics.box_tests.is_multiple_of(BOXES) {
                self.look(asked);
            }
            if Aabb::of_swept_triangle(&x).is_disjoint(&Aabb::of_swept_triangle(&y)) {
                continue;
            }
            self.count_test(asked);
            let relation = asked.filter.relation(pair.0, pair.1);
            self.found.extend(F::of(&asked.filter, relation, pair, &x, &y));
        }
    }
}
