//! Every pair of triangles: the oracle for all other methods.

use super::Statistics;
use super::boxes::{disjoint, triangle_box};
use crate::{ReducedModel, intersect_triangle_triangle};

/// Appends all colliding pairs at q. No hierarchy, no certificates; only boxes of single triangles, compared
/// exactly.
pub(super) fn collide(
    model: &ReducedModel,
    q: &[f64],
    pairs: &mut Vec<(u32, u32)>,
    statistics: &mut Statistics,
) {
    let mesh = model.mesh();
    let corners: Vec<_> = mesh.faces().iter().map(|face| face.map(|v| model.position(v, q))).collect();
    let boxes: Vec<_> = corners.iter().map(|c| triangle_box(*c)).collect();
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            statistics.box_tests += 1;
            if disjoint(&boxes[i], &boxes[j]) || mesh.are_adjacent(i as u32, j as u32) {
                continue;
            }
            statistics.triangle_tests += 1;
            if intersect_triangle_triangle(&corners[i], &corners[j]) {
                pairs.push((i as u32, j as u32));
            }
        }
    }
}
