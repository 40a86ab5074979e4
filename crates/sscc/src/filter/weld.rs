//! Welded vertices: vertices of equal rest position and modes are one vertex, for adjacency only.

use std::cmp::Ordering;

use glam::DVec3;

use crate::ReducedModel;

/// Returns for each vertex its weld class: the lowest vertex with exactly the same position and modes (+0 and -0 are equal).
pub(crate) fn weld_classes(model: &ReducedModel) -> Vec<u32> {
    let (rest, modes) = (model.mesh().rest_positions(), model.modes());
    classes(rest.len(), |i| std::iter::once(&rest[i as usize]).chain(modes.of_vertex(i)))
}

/// Returns for each vertex the lowest one at exactly the same position (+0 and -0 are equal). No position may be NaN.
pub fn weld_classes_of_positions(positions: &[DVec3]) -> Vec<u32> {
    classes(positions.len(), |i| std::iter::once(&positions[i as usize]))
}

/// Returns for each vertex the lowest one with the same vectors, none of which is NaN.
fn classes<'v, I: Iterator<Item = &'v DVec3>>(count: usize, vectors: impl Fn(u32) -> I) -> Vec<u32> {
    let compare = |i: &u32, j: &u32| -> Ordering {
        let numbers = |i: u32| vectors(i).flat_map(|x| x.to_array());
        numbers(*i).partial_cmp(numbers(*j)).unwrap_or(Ordering::Equal)
    };
    let mut sorted: Vec<u32> = (0..count as u32).collect();
    sorted.sort_by(|i, j| compare(i, j).then(i.cmp(j)));
    let mut classes: Vec<u32> = (0..sorted.len() as u32).collect();
    for welded in sorted.chunk_by(|i, j| compare(i, j) == Ordering::Equal) {
        welded.iter().for_each(|&i| classes[i as usize] = welded[0]);
    }
    classes
}
