//! Node pairs.

/// Two nodes of one hierarchy; `(n, n)` stands for the pairs within node n.
pub(crate) type NodePair = (u32, u32);
