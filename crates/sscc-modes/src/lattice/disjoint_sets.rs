//! Disjoint sets with union and find.

/// Disjoint sets of the numbers below a count. The smallest number identifies a set.
pub(super) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Creates one set for each number.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// Returns the smallest number of the set that contains this one.
    pub fn find(&mut self, mut of: u32) -> u32 {
        while self.parent[of as usize] != of {
            let above = self.parent[self.parent[of as usize] as usize];
            self.parent[of as usize] = above;
            of = above;
        }
        of
    }

    /// Unites the sets of two numbers.
    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high as usize] = low;
    }

    /// Returns the number of sets.
    pub fn count(&self) -> usize {
        (0_u32..).zip(&self.parent).filter(|(i, parent)| i == *parent).count()
    }
}
