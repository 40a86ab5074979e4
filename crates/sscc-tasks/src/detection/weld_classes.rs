//! Weld classes of a mesh: vertices that a reader joins, or that are at equal positions at rest and in every frame.

use std::collections::HashMap;

use glam::DVec3;
use sscc::parts::weld_classes_of_positions;

/// Classes of vertices that have been at equal positions so far. The number of a class is that of its first vertex.
pub(super) struct WeldClasses(Vec<u32>);

impl From<&[u32]> for WeldClasses {
    /// Creates the classes from the class of each vertex, which is the number of its first vertex.
    fn from(classes: &[u32]) -> Self {
        Self(classes.to_vec())
    }
}

impl WeldClasses {
    /// Returns the classes at some positions.
    pub fn at(positions: &[DVec3]) -> Self {
        Self(weld_classes_of_positions(positions))
    }

    /// Returns for each vertex the number of its class.
    pub fn numbers(&self) -> &[u32] {
        &self.0
    }

    /// Splits the classes whose vertices are at different positions.
    pub fn split(&mut self, positions: &[DVec3]) {
        if self.0.iter().zip(positions).all(|(class, x)| positions[*class as usize] == *x) {
            return;
        }
        let mut first = HashMap::new();
        for (vertex, (class, x)) in self.0.iter_mut().zip(positions).enumerate() {
            // Adding 0 makes 0 and -0 equal.
            let place = (*x + DVec3::ZERO).to_array().map(f64::to_bits);
            *class = *first.entry((*class, place)).or_insert(vertex as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_stay_welded_while_they_are_together() {
        let at = |xs: [f64; 5]| xs.map(|x| DVec3::new(x, 1.0, -x));
        let mut classes = WeldClasses::at(&at([2.0, 0.0, -0.0, 0.0, 2.0]));
        assert_eq!(classes.numbers(), [0, 1, 1, 1, 0]);
        classes.split(&at([3.0, 5.0, 5.0, 5.0, 3.0]));
        assert_eq!(classes.numbers(), [0, 1, 1, 1, 0]);
        // Vertices of two classes that meet stay in two classes.
        classes.split(&at([3.0, 3.0, 4.0, 3.0, 3.0]));
        assert_eq!(classes.numbers(), [0, 1, 2, 1, 0]);
        classes.split(&at([1.0, 1.0, 1.0, 1.0, 7.0]));
        assert_eq!(classes.numbers(), [0, 1, 2, 1, 4]);
    }
}
