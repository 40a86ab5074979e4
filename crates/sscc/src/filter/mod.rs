//! Which pairs of triangles count as collisions: adjacency, welded vertices, shared-vertex pairs, ignored pairs,
//! groups.

mod common_corners;
mod contact_filter;
mod pair_filter;
mod rings;
mod simplex_pairs;
mod surroundings;
mod triangle_groups;
mod weld;

pub use contact_filter::{ContactFilter, Neighbours, Pair, check_continuous, check_models};
pub(crate) use pair_filter::{GroupsBetween, PairFilter, Relation};
pub(crate) use rings::{RingPairs, Rings};
pub(crate) use simplex_pairs::SimplexPair;
pub(crate) use surroundings::{surroundings, surroundings_between};
pub use triangle_groups::{GroupTable, TriangleGroups};
pub(crate) use weld::weld_classes;
pub use weld::weld_classes_of_positions;
