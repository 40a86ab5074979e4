//! Exceptions: pairs that no radius speaks of, tested exactly in every query, whatever else is skipped.

use super::aabb::{disjoint, triangle_box};
use super::{Method, Query};
use crate::{Certificates, Pair};

impl<'a> Query<'a> {
    /// The pairs that this query must test by itself: those of the certificates it uses.
    pub(super) fn exceptions(&self) -> &'a [Pair] {
        let used = self.certificates.filter(|_| self.method == Method::Certified);
        used.map_or(&[], Certificates::exceptions)
    }

    /// Whether a pair has been tested as an exception.
    pub(super) fn is_exception(&self, pair: Pair) -> bool {
        let exceptions = self.exceptions();
        !exceptions.is_empty() && exceptions.binary_search(&pair).is_ok()
    }

    /// Appends the exceptions that collide at q.
    pub(super) fn test_exceptions(&mut self, q: &[f64]) {
        for &(i, j) in self.exceptions() {
            if self.is_full() {
                return;
            }
            let faces = self.model.mesh().faces();
            let corners = [i, j].map(|t| faces[t as usize]);
            let [x, y] = corners.map(|face| self.boxes.moved_corners(self.model, face, q));
            self.statistics.box_tests += 1;
            if disjoint(&triangle_box(x), &triangle_box(y)) {
                continue;
            }
            self.statistics.triangle_tests += 1;
            if self.filter.collide((i, j), &x, &y) {
                self.pairs.push((i, j));
            }
        }
    }
}
