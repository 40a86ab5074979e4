//! Every pair of triangles: the oracle for all other methods.

use super::Query;
use super::aabb::{disjoint, triangle_box};
use crate::Error;

impl Query<'_> {
    /// Appends all colliding pairs at q. No hierarchy, no certificates; only boxes of single triangles, compared
    /// exactly.
    pub(super) fn brute_force(&mut self, q: &[f64]) -> Result<(), Error> {
        let (model, mesh) = (self.model, self.model.mesh());
        let corners: Vec<_> = mesh.faces().iter().map(|face| face.map(|v| model.position(v, q))).collect();
        let boxes: Vec<_> = corners.iter().map(|c| triangle_box(*c)).collect();
        for i in 0..corners.len() {
            if self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            for j in i + 1..corners.len() {
                if self.is_full() {
                    return Ok(());
                }
                self.statistics.box_tests += 1;
                let pair = (i as u32, j as u32);
                if disjoint(&boxes[i], &boxes[j]) || self.filter.leaves_out(pair.0, pair.1) {
                    continue;
                }
                self.statistics.triangle_tests += 1;
                if self.filter.collide(pair, &corners[i], &corners[j]) {
                    self.pairs.push(pair);
                }
            }
        }
        Ok(())
    }
}
