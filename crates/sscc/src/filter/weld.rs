//! Welded vertices: vertices of equal rest position and modes are one vertex, for adjacency only.

use std::cmp::Ordering;

use crate::ReducedModel;

/// For each vertex its weld class: the lowest vertex with exactly the same position and modes (+0 and -0 are equal).
pub(crate) fn weld_classes(model: &ReducedModel) -> Vec<u32> {
    let (mesh, modes) = (model.mesh(), model.modes());
    let compare = |i: &u32, j: &u32| -> Ordering {
        let numbers = |i: u32| {
            std::iter::once(&mesh.rest_positions()[i as usize])
                .chain(modes.of_vertex(i))
                .flat_map(|x| x.to_array())
        };
        // No number here is NaN.
        numbers(*i).partial_cmp(numbers(*j)).unwrap_or(Ordering::Equal)
    };
    let mut sorted: Vec<u32> = (0..mesh.rest_positions().len() as u32).collect();
    sorted.sort_by(|i, j| compare(i, j).then(i.cmp(j)));
    let mut classes: Vec<u32> = (0..sorted.len() as u32).collect();
    for welded in sorted.chunk_by(|i, j| compare(i, j) == Ordering::Equal) {
        welded.iter().for_each(|&i| classes[i as usize] = welded[0]);
    }
    classes
}
