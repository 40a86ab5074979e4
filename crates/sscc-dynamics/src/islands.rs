//! Islands: sets of bodies that contacts connect.

use sscc_solid::DisjointSets;

/// Bodies joined by contacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    sets: DisjointSets,
}

impl Islands {
    /// Makes each body an island of its own.
    pub fn reset(&mut self, bodies: usize) {
        self.sets.reset(bodies);
    }

    /// Returns the number of a body's island: that of its first body.
    pub fn of(&mut self, body: usize) -> usize {
        self.sets.find(body as u32) as usize
    }

    /// Joins the islands of two bodies.
    pub fn join(&mut self, a: usize, b: usize) {
        self.sets.unite(a as u32, b as u32);
    }
}
