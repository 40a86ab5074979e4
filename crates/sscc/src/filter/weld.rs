//! Welded vertices: vertices of equal rest position and modes are one vertex, for adjacency only.

use std::cmp::Ordering;

use glam::DVec3;

use crate::ReducedModel;

/// Returns for each vertex its weld class: the lowest vertex with exactly the same position and modes (+0 and -0 are equal).
pub(crate) fn weld_classes(model: &ReducedModel) -> Vec<u32> {
    let (rest, modes) = (model.mesh().rest_positions(), model.modes());
    classes(rest.len(), |i| std::iter::once(&rest[i as usize]).chain(modes.of_vertex(i)))
}

/// Returns for each vertex the lowest one at exactly the same position (+0 and -0 are equal; NaN is equal to the same NaN).
pub fn weld_classes_of_positions(positions: &[DVec3]) -> Vec<u32> {
    classes(positions.len(), |i| std::iter::once(&positions[i as usize]))
}

/// Returns for each vertex the lowest one with the same vectors.
fn classes<'v, I: Iterator<Item = &'v DVec3>>(count: usize, vectors: impl Fn(u32) -> I) -> Vec<u32> {
    let compare = |i: &u32, j: &u32| -> Ordering {
        let numbers = |i: u32| vectors(i).flat_map(|x| x.to_array());
        // A total order, also of NaN: a sort panics without one.
        let order = |(x, y): (f64, f64)| x.partial_cmp(&y).unwrap_or_else(|| x.total_cmp(&y));
        numbers(*i).zip(numbers(*j)).map(order).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    };
    let mut sorted: Vec<u32> = (0..count as u32).collect();
    sorted.sort_by(|i, j| compare(i, j).then(i.cmp(j)));
    let mut classes: Vec<u32> = (0..sorted.len() as u32).collect();
    for welded in sorted.chunk_by(|i, j| compare(i, j) == Ordering::Equal) {
        welded.iter().for_each(|&i| classes[i as usize] = welded[0]);
    }
    classes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_of_any_numbers_have_classes() {
        let numbers = [0.0, -0.0, f64::NAN, -f64::NAN, f64::INFINITY, 1.0, f64::NAN, 0.0];
        assert_eq!(weld_classes_of_positions(&numbers.map(DVec3::splat)), [0, 0, 2, 3, 4, 5, 2, 0]);
        // Without a total order, the standard library panics in a sort of this many.
        let many: Vec<DVec3> = (0..400).map(|i| DVec3::splat(numbers[i * 7 % 5] * i as f64)).collect();
        let classes = weld_classes_of_positions(&many);
        assert!(classes.iter().zip(0..).all(|(class, i)| *class <= i && classes[*class as usize] == *class));
    }
}
