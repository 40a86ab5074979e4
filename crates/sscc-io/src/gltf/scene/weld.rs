//! Weld classes: vertices that move as one.

use std::cmp::Ordering;

use glam::DVec3;

use super::influences::Influences;

/// Returns the class of each vertex: the smallest index of a vertex with equal rest position, displacements (`rank` for
/// each vertex) and influences. 0 and -0 are equal; numbers must be finite.
pub(super) fn weld_classes(
    rest: &[DVec3],
    rank: usize,
    displacements: &[DVec3],
    influences: Option<&Influences>,
) -> Vec<u32> {
    let of_vertex = |vertex: u32| {
        let displacements = &displacements[vertex as usize * rank..][..rank];
        let vectors = std::iter::once(&rest[vertex as usize]).chain(displacements);
        let joints = influences.map_or(&[][..], |influences| influences.of_vertex(vertex as usize));
        let numbers = joints.iter().flat_map(|(joint, weight)| [f64::from(*joint), *weight]);
        vectors.flat_map(|vector| vector.to_array()).chain(numbers)
    };
    let compare = |a: &u32, b: &u32| of_vertex(*a).partial_cmp(of_vertex(*b)).unwrap_or(Ordering::Equal);
    let mut order: Vec<u32> = (0..rest.len() as u32).collect();
    // The sort is stable, so the first of equal vertices has the smallest index.
    order.sort_by(compare);
    let mut classes = vec![0; rest.len()];
    for class in order.chunk_by(|a, b| compare(a, b) == Ordering::Equal) {
        class.iter().for_each(|vertex| classes[*vertex as usize] = class[0]);
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_motion_makes_one_class() {
        let (x, y) = (DVec3::X, DVec3::Y);
        let rest = [x, y, x * 1.0, y, DVec3::new(1.0, -0.0, -0.0), x];
        assert_eq!(weld_classes(&rest, 0, &[], None), [0, 1, 0, 1, 0, 0]);
        let moved = [x, x, x, y, -x, x];
        assert_eq!(weld_classes(&rest, 1, &moved, None), [0, 1, 0, 3, 4, 0]);
        assert_eq!(weld_classes(&[], 0, &[], None), [0; 0]);
    }
}
