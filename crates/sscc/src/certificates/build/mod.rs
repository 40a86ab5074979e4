//! How certificates are computed.

pub(crate) mod global_radius;
pub(crate) mod node_radii;
pub(crate) mod pair_tree_builder;
pub(crate) mod search;
pub(crate) mod task;
