//! Tests of every pair of triangles: the oracle for all other methods.

use glam::DVec3;

use super::broad_phase::BroadPhase;
use super::context::Context;
use super::narrow_phase::NarrowPhase;
use crate::Error;
use crate::geometry::Aabb;

impl<const E: usize> BroadPhase<E> {
    /// Finds at most `limit` hits among all pairs of triangles, exceptions included, by the positions of vertices at each
    /// configuration. It uses no hierarchy and no certificates; only AABBs of single triangles, compared exactly.
    ///
    /// # Errors
    /// When the search was cancelled; then there are no hits.
    pub(crate) fn brute_force<N: NarrowPhase<E>>(
        &mut self,
        context: &Context,
        positions: impl Fn(u32) -> [DVec3; E],
        narrow: &mut N,
        limit: usize,
    ) -> Result<(), Error> {
        let state = &mut self.state;
        state.begin();
        narrow.hits().begin(limit);
        let corners: Vec<[[DVec3; 3]; E]> = context
            .filter
            .faces()
            .iter()
            .map(|face| {
                let corners = face.map(&positions);
                std::array::from_fn(|end| corners.map(|x| x[end]))
            })
            .collect();
        let boxes: Vec<Aabb> = corners.iter().map(Aabb::of_swept_triangle).collect();
        'all: for a in 0..corners.len() {
            state.check_cancelled(context, narrow);
            for b in a + 1..corners.len() {
                if narrow.hits().note_if_full() {
                    break 'all;
                }
                state.counters.box_tests += 1;
                let pair = (a as u32, b as u32);
                if boxes[a].is_disjoint(&boxes[b]) || context.filter.is_excluded(pair.0, pair.1) {
                    continue;
                }
                state.counters.triangle_tests += 1;
                let relation = context.filter.relation(pair.0, pair.1);
                let hit = narrow.test(&context.filter, relation, pair, &corners[a], &corners[b]);
                narrow.hits().list.extend(hit);
            }
        }
        state.end(narrow)
    }
}
