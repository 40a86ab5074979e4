//! Islands: sets of bodies that contacts connect.

use std::ops::{Index, IndexMut};

use sscc::parts::DisjointSets;

use crate::bodies::body_set::BodySet;

/// Number of an island: that of its first body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Island(u32);

/// Bodies joined by contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    bodies: usize,
    sets: DisjointSets,
}

impl Islands {
    /// Makes each body an island of its own.
    pub fn reset(&mut self, bodies: usize) {
        self.bodies = bodies;
        self.sets.reset(bodies);
    }

    /// Returns the island of a body.
    pub fn of(&mut self, body: usize) -> Island {
        Island(self.sets.find(body as u32))
    }

    /// Joins the islands of two bodies.
    pub fn join(&mut self, a: usize, b: usize) {
        self.sets.unite(a as u32, b as u32);
    }

    /// Makes `bodies` the set of all bodies of the selected islands.
    pub fn select(&mut self, selected: &PerIsland<bool>, bodies: &mut BodySet) {
        bodies.set((0..self.bodies).map(|n| selected[self.of(n)]));
    }
}

/// A value for each island.
#[derive(Clone, Debug)]
pub(crate) struct PerIsland<T>(Vec<T>);

impl<T> Default for PerIsland<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: Clone> PerIsland<T> {
    /// Sets the same value for all islands of a world with `bodies` bodies.
    pub fn reset(&mut self, bodies: usize, value: T) {
        self.0.clear();
        self.0.resize(bodies, value);
    }
}

impl<T> Index<Island> for PerIsland<T> {
    type Output = T;

    fn index(&self, island: Island) -> &T {
        &self.0[island.0 as usize]
    }
}

impl<T> IndexMut<Island> for PerIsland<T> {
    fn index_mut(&mut self, island: Island) -> &mut T {
        &mut self.0[island.0 as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_of_selected_islands_are_selected() {
        let (mut islands, mut selected, mut bodies) =
            (Islands::default(), PerIsland::default(), BodySet::default());
        islands.reset(5);
        islands.join(3, 1);
        selected.reset(5, false);
        for body in [3, 4] {
            selected[islands.of(body)] = true;
        }
        islands.select(&selected, &mut bodies);
        assert_eq!(bodies.members().collect::<Vec<_>>(), [1, 3, 4]);
    }
}
