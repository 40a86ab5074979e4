//! Validation of a pair tree that was read from a file, against its hierarchy.
//!
//! Every entry is visited once, in order: a list of siblings must start right after the one before. So the check of any
//! bytes ends after linear time.

use super::pair_tree::{MAX_ENTRIES, NO_PAIRS, PairTree, sibling_pairs};
use crate::hierarchy::{Hierarchy, NodePair};

/// All siblings that a list may name, and the radius of their parent.
struct Siblings<F> {
    count: usize,
    pair: F,
    parent_radius: f32,
}

impl PairTree {
    /// Returns the nodes of each entry, in order.
    ///
    /// # Errors
    /// If the tree does not fit this hierarchy.
    pub(crate) fn pairs(&self, hierarchy: &Hierarchy) -> Result<Vec<NodePair>, &'static str> {
        let limit = self.limit();
        if limit.is_nan() || limit < 0.0 || limit.is_infinite() {
            return Err("its limit is negative or not finite");
        }
        if limit == 0.0 {
            let is_empty = self.is_empty() && self.starts().is_empty();
            return if is_empty { Ok(Vec::new()) } else { Err("it has pairs, but no limit") };
        }
        if self.starts().len() != hierarchy.nodes().len() {
            return Err("the number of starts is not the number of nodes");
        }
        if self.len() > MAX_ENTRIES {
            return Err("it has more node pairs than its indices can address");
        }
        let mut pairs: Vec<NodePair> = Vec::new();
        for (n, start) in self.starts().iter().enumerate() {
            if *start == NO_PAIRS {
                continue;
            }
            let all: Vec<NodePair> = sibling_pairs(hierarchy, n as u32).collect();
            let siblings = Siblings { count: all.len(), pair: |which| all[which], parent_radius: 0.0 };
            self.append(*start, &siblings, &mut pairs)?;
        }
        let mut index = 0;
        while let Some(&(n, m)) = pairs.get(index) {
            let entry = self.entry(index);
            match hierarchy.split_above_buckets(n, m) {
                None if entry.start() != 0 => return Err("a pair of buckets has children"),
                None => {}
                Some(split) => {
                    let pair = |which| split.pair(which as u32);
                    let siblings =
                        Siblings { count: split.children().len(), pair, parent_radius: entry.radius };
                    self.append(entry.start(), &siblings, &mut pairs)?;
                }
            }
            index += 1;
        }
        if index == self.len() { Ok(pairs) } else { Err("some pairs have no parent") }
    }

    /// Appends the nodes of the list of siblings at `start`.
    fn append(
        &self,
        start: u32,
        siblings: &Siblings<impl Fn(usize) -> NodePair>,
        pairs: &mut Vec<NodePair>,
    ) -> Result<(), &'static str> {
        if start as usize != pairs.len() {
            return Err("lists of siblings are out of order");
        }
        let mut next = 0;
        for entry in (start as usize..self.len()).map(|index| self.entry(index)) {
            if entry.radius.is_nan() || entry.radius < 0.0 {
                return Err("a radius is negative or not a number");
            }
            if with_mutant!(f64::from(entry.radius) >= self.limit(), TreeRadiusAtLimitAccepted, false) {
                return Err("a radius is not below the limit");
            }
            if with_mutant!(entry.radius < siblings.parent_radius, TreeRadiusAboveChildAccepted, false) {
                return Err("a pair's radius exceeds that of a child");
            }
            let which = entry.which() as usize;
            if which < next || which >= siblings.count {
                return Err("a child is listed twice or does not exist");
            }
            next = which + 1;
            pairs.push((siblings.pair)(which));
            if entry.is_last() {
                return Ok(());
            }
        }
        Err("a list of siblings does not end")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hierarchy::Node;

    #[test]
    fn entries_name_each_child_at_most_once() {
        let node = |first_triangle, triangle_count, first_child, child_count| Node {
            first_triangle,
            triangle_count,
            first_child,
            child_count,
        };
        let top = [node(0, 194, 1, 3), node(0, 65, 4, 2), node(65, 65, 6, 2), node(130, 64, 8, 2)];
        let leaves = [(0, 33), (33, 32), (65, 33), (98, 32), (130, 32), (162, 32)];
        let nodes = [&top[..], &leaves.map(|(first, count)| node(first, count, 0, 0))].concat();
        let hierarchy = Hierarchy::from_parts(nodes, (0..194).collect(), 194).unwrap();
        // The second of three pairs of the root's children, and its two children.
        let (last, none) = (1 << 31, u32::MAX);
        let pairs = |which: [u32; 3]| {
            let starts = [vec![0], vec![none; 9]].concat();
            let entries =
                [(0.1, last | which[0] << 28 | 1), (0.2, which[1] << 28), (0.3, last | which[2] << 28)];
            PairTree::from_parts(1.0, starts, entries).pairs(&hierarchy)
        };
        assert_eq!(pairs([1, 0, 1]), Ok(vec![(1, 3), (4, 3), (5, 3)]));
        for bad in [[3, 0, 1], [1, 0, 2], [1, 0, 0], [1, 1, 0]] {
            assert_eq!(pairs(bad), Err("a child is listed twice or does not exist"), "{bad:?}");
        }
    }
}
