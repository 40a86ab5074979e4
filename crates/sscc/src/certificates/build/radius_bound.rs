//! Input and result of a radius search: node pairs with lower bounds; a certified radius with an upper bound.

use crate::hierarchy::NodePair;

/// A node pair and a lower bound of its radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BoundedNodePair {
    pub(crate) nodes: NodePair,
    /// 0 if the pair has not been bounded yet.
    pub(crate) lower: f64,
}

impl BoundedNodePair {
    /// Creates a pair that has not been bounded yet.
    pub(crate) fn unbounded(nodes: NodePair) -> Self {
        Self { nodes, lower: 0.0 }
    }
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RadiusBound {
    /// The certified radius: no triangle pair searched collides below it.
    pub(crate) radius: f64,
    /// The smallest upper bound found of any such pair's radius; infinite if none was found.
    pub(crate) upper: f64,
}
