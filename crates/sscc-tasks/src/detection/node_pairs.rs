//! Queries of the meshes of the nodes of a scene against each other, frame by frame.

use std::sync::Arc;

use super::ignored_between::IgnoredBetween;
use super::moving_mesh::MovingMesh;
use super::node_boxes::{are_apart, boxes};
use super::request::Detection;
use super::worker::{QueryResult, Side, query};
use crate::error::{At, Result};

/// A detector for each mesh, and its positions at one frame. Positions are evaluated once for all pairs.
pub(super) struct NodePairs<'m, 'w> {
    request: &'m Detection,
    sides: Vec<Side<'m, 'w>>,
    ignored: &'m IgnoredBetween,
}

impl<'m, 'w> NodePairs<'m, 'w> {
    pub fn new(
        request: &'m Detection,
        meshes: &'m [Arc<MovingMesh<'w>>],
        ignored: &'m IgnoredBetween,
    ) -> Self {
        Self { request, sides: meshes.iter().map(|mesh| Side::new(mesh)).collect(), ignored }
    }

    /// Answers the queries of all pairs of meshes at a frame. Returns the answers with colliding (or near) pairs, in order.
    pub fn answer(&mut self, frame: usize) -> Result<Vec<([usize; 2], QueryResult)>> {
        let Self { request, sides, ignored } = self;
        sides.iter_mut().try_for_each(|side| side.read(frame, request.is_continuous))?;
        let boxes = boxes(sides);
        let reach = request.clearance.map_or(0.0, |clearance| clearance.distance());
        let mut found = Vec::new();
        for b in 1..sides.len() {
            let (before, from_b) = sides.split_at_mut(b);
            for a in 0..b {
                if are_apart(&boxes[a], &boxes[b], reach) {
                    continue;
                }
                let side = &mut before[a];
                let (mesh, other) = (side.mesh, &mut from_b[0]);
                let ignored = ignored.of([a, b]);
                let limit = if ignored.is_empty() { request.limit } else { None };
                let result = query(request, limit, (side, Some(other)), false).at(|| mesh.place(frame))?;
                let mut result = result.without(ignored, request.limit);
                if result.pairs.is_empty() {
                    continue;
                }
                if request.has_positions {
                    let sides = [&before[a], &from_b[0]];
                    result.positions = sides.map(|side| [side.x_t0.clone(), side.x_t1.clone()]).into();
                }
                found.push(([a, b], result));
            }
        }
        found.sort_by_key(|(nodes, _)| *nodes);
        Ok(found)
    }
}
