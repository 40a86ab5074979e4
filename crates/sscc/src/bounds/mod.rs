//! Lower bounds of the distance, in reduced coordinates, at which two parts of a model can first meet
//! (paper, section 5), and how they are rounded.
//!
//! Every bound here is *certified*: it is at most the exact minimum of `|z|` over all z at which the
//! **computed** f64 positions of the two parts meet. Directions, affine maps and mean modes may come from
//! any heuristic in any precision; only the last evaluation is rounded with care.

mod affine;
mod cone;
mod contact_estimate;
mod leaf_pair;
mod line;
mod node_pair;
#[cfg(test)]
mod reference;
#[cfg(test)]
mod rounding_tests;
mod separating_direction;
#[cfg(test)]
mod tests;
mod triangle_pair;

pub(crate) use leaf_pair::LeafPair;
pub(crate) use line::{MovingAabb, Path};
pub(crate) use node_pair::{ClusterBounds, ClusterScratch, cluster_pair};
pub(crate) use separating_direction::{TrianglePair, direction_bound};
pub(crate) use triangle_pair::{PairRefiner, Target};
