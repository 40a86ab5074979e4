//! Every pair of triangles: the oracle for all other methods.

use glam::DVec3;

use crate::detect::narrow_phase::Found;
use crate::detect::search::Finder;
use crate::geometry::Aabb;
use crate::query::context::{Asked, Ends};

impl<F: Found<E>, const E: usize> Finder<F, E> {
    /// Adds all that counts among all pairs of triangles. No hierarchy, no certificates;
    /// only boxes of single triangles, compared exactly.
    pub(crate) fn brute_force(&mut self, asked: &Asked<'_>, ends: &Ends<'_, E>) {
        let faces = asked.model.mesh().faces();
        let corners: Vec<[[DVec3; 3]; E]> =
            faces.iter().map(|face| ends.q.map(|q| face.map(|v| asked.model.position(v, q)))).collect();
        let boxes: Vec<Aabb> = corners.iter().map(Aabb::of_swept_triangle).collect();
        for i in 0..corners.len() {
            self.look(asked);
            for j in i + 1..corners.len() {
                if self.is_full() {
                    return;
                }
                self.statistics.box_tests += 1;
                let pair = (i as u32, j as u32);
                if boxes[i].is_disjoint(&boxes[j]) || asked.filter.is_excluded(pair.0, pair.1) {
                    continue;
                }
                self.statistics.triangle_tests += 1;
                let relation = asked.filter.relation(pair.0, pair.1);
                self.found.extend(F::of(&asked.filter, relation, pair, &corners[i], &corners[j]));
            }
        }
    }
}
