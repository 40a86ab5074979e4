//! The meshes of the nodes of a scene against each other, frame by frame.

use std::sync::Arc;

use sscc::parts::Aabb;

use super::moving_mesh::MovingMesh;
use super::request::Detection;
use super::worker::{QueryResult, Side, query};
use crate::error::{At, Result};

/// A detector for each mesh, and its positions at one frame. Positions are evaluated once for all pairs.
pub(super) struct NodePairs<'m, 'w> {
    request: &'m Detection,
    sides: Vec<Side<'m, 'w>>,
}

impl<'m, 'w> NodePairs<'m, 'w> {
    pub fn new(request: &'m Detection, meshes: &'m [Arc<MovingMesh<'w>>]) -> Self {
        Self { request, sides: meshes.iter().map(|mesh| Side::new(mesh)).collect() }
    }

    /// Answers the queries of all pairs of meshes at a frame. Returns those with colliding (or near) pairs, in order.
    pub fn answer(&mut self, frame: usize) -> Result<Vec<([usize; 2], QueryResult)>> {
        let Self { request, sides } = self;
        sides.iter_mut().try_for_each(|side| side.read(frame, request.is_continuous))?;
        let boxes: Vec<Aabb> =
            sides.iter().map(|side| Aabb::of_points(side.x_t0.iter().chain(&side.x_t1).copied())).collect();
        let reach = request.clearance.map_or(0.0, |clearance| clearance.distance());
        let mut found = Vec::new();
        for b in 1..sides.len() {
            let (before, from_b) = sides.split_at_mut(b);
            for (a, side) in before.iter_mut().enumerate() {
                if are_apart(&boxes[a], &boxes[b], reach) {
                    continue;
                }
                let mesh = side.mesh;
                let result = query(request, (side, Some(&mut from_b[0])), false).at(|| mesh.place(frame))?;
                if !result.pairs.is_empty() {
                    found.push(([a, b], result));
                }
            }
        }
        found.sort_by_key(|(nodes, _)| *nodes);
        Ok(found)
    }
}

/// Whether two boxes are farther apart along an axis than a distance. No collision is missed: a difference that is at most the
/// distance also rounds to at most the distance, because rounding is monotone.
fn are_apart(a: &Aabb, b: &Aabb, distance: f64) -> bool {
    let is_beyond = |low: f64, high: f64| low - high > distance;
    (0..3).any(|k| is_beyond(a.lower[k], b.upper[k]) || is_beyond(b.lower[k], a.upper[k]))
}
