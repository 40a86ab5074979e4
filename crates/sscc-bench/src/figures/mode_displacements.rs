//! Largest displacements of vertices by modes.

use sscc::ReducedModel;

/// Returns the largest displacement of a vertex by each mode at weight 1 (model unit).
pub fn largest_displacements(model: &ReducedModel) -> Vec<f64> {
    let modes = model.modes();
    let mut largest = vec![0.0_f64; modes.rank()];
    for of_vertex in modes.displacements().chunks(modes.rank()) {
        largest.iter_mut().zip(of_vertex).for_each(|(most, u)| *most = most.max(u.length()));
    }
    largest
}
