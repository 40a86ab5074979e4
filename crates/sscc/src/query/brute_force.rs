//! Every pair of triangles: the oracle for all other methods.

use glam::DVec3;

use super::aabb::{Aabb, around, disjoint};
use super::asked::{Asked, Ends};
use super::finder::Finder;
use super::found::Found;

impl<F: Found<E>, const E: usize> Finder<F, E> {
    /// Adds all that counts among all pairs of triangles. No hierarchy, no certificates;
    /// only boxes of single triangles, compared exactly.
    pub(super) fn brute_force(&mut self, asked: &Asked<'_>, ends: &Ends<'_, E>) {
        let faces = asked.model.mesh().faces();
        let corners: Vec<[[DVec3; 3]; E]> =
            faces.iter().map(|face| ends.q.map(|q| face.map(|v| asked.model.position(v, q)))).collect();
        let boxes: Vec<Aabb> = corners.iter().map(around).collect();
        for i in 0..corners.len() {
            self.look(asked);
            for j in i + 1..corners.len() {
                if self.is_full() {
                    return;
                }
                self.statistics.box_tests += 1;
                let pair = (i as u32, j as u32);
                if disjoint(&boxes[i], &boxes[j]) || asked.filter.leaves_out(pair.0, pair.1) {
                    continue;
                }
                self.statistics.triangle_tests += 1;
                let relation = asked.filter.relation(pair.0, pair.1);
                self.found.extend(F::of(&asked.filter, relation, pair, &corners[i], &corners[j]));
            }
        }
    }
}
