//! Sets of numbers that are united step by step.

/// Disjoint sets of the numbers below a count. A set goes by its smallest number.
pub(super) struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// Each number alone.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// The smallest number of the set that holds this one.
    pub fn find(&mut self, mut of: u32) -> u32 {
        while self.parent[of as usize] != of {
            let above = self.parent[self.parent[of as usize] as usize];
            self.parent[of as usize] = above;
            of = above;
        }
        of
    }

    /// Makes one set of the two that hold these.
    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high as usize] = low;
    }

    /// The number of sets.
    pub fn count(&self) -> usize {
        (0_u32..).zip(&self.parent).filter(|(i, parent)| i == *parent).count()
    }
}
