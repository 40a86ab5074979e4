//! The check of a hierarchy from a file: it must be a tree over all triangles in the documented order.

use super::hierarchy::Hierarchy;
use super::node::{BRANCHING, Node};
use crate::Error;

/// Leaves of a hierarchy from a file have at most this many triangles.
const MAX_LEAF_TRIANGLES: u32 = 64;

/// A hierarchy from a file has at most this many levels. Built hierarchies have at most log N / log(8/7) levels, 166 for 2^32
/// triangles. With [`MAX_LEAF_TRIANGLES`] it bounds the time of traversals.
const MAX_LEVELS: usize = 256;

impl Hierarchy {
    /// Creates a hierarchy from its parts, as read from a file.
    ///
    /// # Errors
    /// When the parts are not a tree over exactly `triangles` triangles in the documented order, a leaf has more than
    /// 64 triangles, or there are more than 256 levels.
    pub fn from_parts(nodes: Vec<Node>, order: Vec<u32>, triangles: usize) -> Result<Self, Error> {
        check_order(&order, triangles)?;
        check_tree(&nodes, triangles)?;
        if nodes.iter().any(|node| node.is_leaf() && node.triangle_count > MAX_LEAF_TRIANGLES) {
            return Err(damaged("a leaf has more than 64 triangles"));
        }
        let hierarchy = Self { nodes, order };
        if hierarchy.levels().len() > MAX_LEVELS {
            return Err(damaged("it has more than 256 levels"));
        }
        Ok(hierarchy)
    }
}

fn damaged(what: &str) -> Error {
    Error::Certificates(format!("hierarchy: {what}"))
}

/// Checks that `order` lists each triangle once.
fn check_order(order: &[u32], triangles: usize) -> Result<(), Error> {
    let mut seen = vec![false; triangles];
    if order.len() != triangles {
        return Err(damaged("its triangles are not this mesh's"));
    }
    for &a in order {
        match seen.get_mut(a as usize) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(damaged("a triangle is listed twice or does not exist")),
        }
    }
    Ok(())
}

/// Checks that nodes are stored level by level, and that the triangles of each node are the disjoint union of those of its
/// children.
fn check_tree(nodes: &[Node], triangles: usize) -> Result<(), Error> {
    let Some(root) = nodes.first() else { return Err(damaged("it has no nodes")) };
    if (root.first_triangle, root.triangle_count as usize) != (0, triangles) {
        return Err(damaged("its root does not hold all triangles"));
    }
    let mut next_child = 1_u64;
    for node in nodes {
        if node.triangle_count == 0 {
            return Err(damaged("a node is empty"));
        }
        if node.is_leaf() {
            if node.first_child != 0 {
                return Err(damaged("a leaf names a child"));
            }
            continue;
        }
        let end = u64::from(node.first_child) + u64::from(node.child_count);
        let fits = (2..=BRANCHING as u32).contains(&node.child_count)
            && u64::from(node.first_child) == next_child
            && end <= nodes.len() as u64;
        if !fits {
            return Err(damaged("children are out of order"));
        }
        next_child = end;
        let mut first = u64::from(node.first_triangle);
        for child in &nodes[node.first_child as usize..end as usize] {
            if u64::from(child.first_triangle) != first {
                return Err(damaged("a node is not the disjoint union of its children"));
            }
            first += u64::from(child.triangle_count);
        }
        if first != u64::from(node.first_triangle) + u64::from(node.triangle_count) {
            return Err(damaged("a node is not the disjoint union of its children"));
        }
    }
    if next_child != nodes.len() as u64 {
        return Err(damaged("some nodes have no parent"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(first_triangle: u32, triangle_count: u32, first_child: u32, child_count: u32) -> Node {
        Node { first_triangle, triangle_count, first_child, child_count }
    }

    #[test]
    fn only_trees_over_all_triangles_are_hierarchies() {
        let is_tree = |nodes: &[Node], order: &[u32]| {
            Hierarchy::from_parts(nodes.to_vec(), order.to_vec(), nodes[0].triangle_count as usize).is_ok()
        };
        let leaf = |first| node(first, 1, 0, 0);
        let inner = |children: [u32; 3]| {
            let halves = [0, 1, 2].map(|i| node(2 * i, 2, children[i as usize], 2));
            [&[node(0, 6, 1, 3)][..], &halves].concat()
        };
        let good = [inner([4, 6, 8]), (0..6).map(leaf).collect()].concat();
        assert!(is_tree(&good, &[3, 1, 2, 0, 5, 4]));
        assert!(!is_tree(&good, &[0, 1, 2, 3, 4, 4]) && !is_tree(&good, &[0, 1, 2, 3, 4, 6]));
        assert!(!is_tree(&good[..9], &[0, 1, 2, 3, 4, 5]));
        let swapped = [inner([6, 4, 8]), [2, 3, 0, 1, 4, 5].map(leaf).to_vec()].concat();
        assert!(!is_tree(&swapped, &[0, 1, 2, 3, 4, 5]));
        let five = [vec![node(0, 5, 1, 5)], (0..5).map(leaf).collect()].concat();
        assert!(!is_tree(&five, &[0, 1, 2, 3, 4]));
        assert!(!is_tree(&[node(0, 1, 0, 1)], &[0]) && !is_tree(&[node(0, 1, 1, 1), leaf(0)], &[0]));
    }

    /// Which node of a pair is split is part of the format of pair trees.
    #[test]
    fn the_larger_inner_node_of_a_pair_is_split() {
        let top = [node(0, 194, 1, 3), node(0, 65, 4, 2), node(65, 65, 6, 2), node(130, 64, 8, 2)];
        let leaves = [(0, 33), (33, 32), (65, 33), (98, 32), (130, 32), (162, 32)];
        let nodes = [&top[..], &leaves.map(|(first, count)| node(first, count, 0, 0))].concat();
        let hierarchy = Hierarchy::from_parts(nodes, (0..194).collect(), 194).unwrap();
        let split = |n, m| hierarchy.split(n, m).map(|split| split.pairs().collect::<Vec<_>>());
        // Of two nodes of 65 triangles the first is split; never a leaf.
        assert_eq!([split(1, 2), split(2, 1)], [Some(vec![(4, 2), (5, 2)]), Some(vec![(6, 1), (7, 1)])]);
        assert_eq!([split(3, 1), split(3, 4)], [Some(vec![(3, 4), (3, 5)]), Some(vec![(8, 4), (9, 4)])]);
        assert_eq!([split(4, 3), split(4, 5)], [Some(vec![(4, 8), (4, 9)]), None]);
        assert!(
            hierarchy.split_above_buckets(3, 4).is_none() && hierarchy.split_above_buckets(1, 4).is_some()
        );
    }
}
