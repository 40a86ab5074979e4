//! The split of a node pair: one of the two nodes is replaced by its children.

use std::ops::Range;

use super::node::Node;
use super::node_pair::NodePair;

/// A node pair (n, m) and the node of it that is split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Split {
    /// The first node is split.
    First {
        /// The first node.
        node: Node,
        /// The index of the second node.
        m: u32,
    },
    /// The second node is split.
    Second {
        /// The index of the first node.
        n: u32,
        /// The second node.
        node: Node,
    },
}

impl Split {
    /// Returns the children of the node that is split.
    #[inline]
    pub(crate) fn children(&self) -> Range<u32> {
        match self {
            Self::First { node, .. } | Self::Second { node, .. } => node.children(),
        }
    }

    /// Returns the node pair with the child of that number (0 to 3).
    #[inline]
    pub(crate) fn pair(&self, child: u32) -> NodePair {
        match self {
            Self::First { node, m } => (node.first_child + child, *m),
            Self::Second { n, node } => (*n, node.first_child + child),
        }
    }

    /// Returns all node pairs, child by child.
    #[inline]
    pub(crate) fn pairs(self) -> impl Iterator<Item = NodePair> {
        (0..self.children().len() as u32).map(move |child| self.pair(child))
    }
}
