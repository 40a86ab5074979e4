//! Which pairs of triangles count as collisions: adjacency, welded vertices, shared-vertex pairs, ignored pairs.

mod contact_filter;
mod pair_filter;
mod weld;

pub use contact_filter::{ContactFilter, Neighbours, Pair};
pub(crate) use pair_filter::{Hulls, PairFilter, Relation};
pub(crate) use weld::{weld_classes, weld_classes_of_positions};
