//! Disjoint sets, which contacts or common corners unite.

/// Disjoint sets of the numbers below a count (a union-find forest). The smallest number identifies a set. Other numbers panic.
#[derive(Clone, Debug, Default)]
pub struct DisjointSets {
    parents: Vec<u32>,
}

impl DisjointSets {
    /// Creates one set for each number.
    pub fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// Separates all sets, into one for each number below `count`.
    pub fn reset(&mut self, count: usize) {
        self.parents.clear();
        self.parents.extend(0..count as u32);
    }

    /// Returns the smallest number of the set that contains this one.
    pub fn find(&mut self, mut number: u32) -> u32 {
        while self.parents[number as usize] != number {
            // Halves the path.
            let above = self.parents[self.parents[number as usize] as usize];
            self.parents[number as usize] = above;
            number = above;
        }
        number
    }

    /// Unites the sets of two numbers.
    pub fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b) as usize] = a.min(b);
    }

    /// Returns the number of sets.
    pub fn count(&self) -> usize {
        (0_u32..).zip(&self.parents).filter(|(i, parent)| i == *parent).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn find_returns_the_smallest_number_of_each_set() {
        let mut sets = DisjointSets::new(2);
        sets.reset(7);
        for (a, b) in [(5, 3), (6, 1), (3, 6), (2, 4)] {
            sets.unite(a, b);
        }
        assert_eq!([0, 1, 2, 3, 4, 5, 6].map(|n| sets.find(n)), [0, 1, 2, 1, 2, 1, 1]);
        assert_eq!(sets.count(), 3);
    }
}
