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
