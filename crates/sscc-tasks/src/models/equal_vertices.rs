//! Test for vertices that `--weld` would join.

use std::cmp::Ordering;

use sscc::ReducedModel;

/// Whether two vertices of triangles have equal positions and modes, as along texture seams. Certificates should then weld them.
pub fn has_equal_vertices(model: &ReducedModel) -> bool {
    let of = |v: u32| {
        let position = std::iter::once(&model.mesh().rest_positions()[v as usize]);
        position.chain(model.modes().of_vertex(v)).flat_map(|x| x.to_array())
    };
    let mut used = model.mesh().used_vertices().to_vec();
    // No number of a model is NaN.
    let compare = |a: &u32, b: &u32| of(*a).partial_cmp(of(*b)).unwrap_or(Ordering::Equal);
    used.sort_by(compare);
    used.windows(2).any(|pair| compare(&pair[0], &pair[1]) == Ordering::Equal)
}
