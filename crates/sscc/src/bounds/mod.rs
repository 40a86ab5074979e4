//! Lower bounds of the distance, in reduced coordinates, at which two parts of a model can first meet
//! (paper, section 5), and how they are rounded.
//!
//! Every bound here is *certified*: it is at most the exact minimum of `|z|` over all z at which the
//! **computed** f64 positions of the two parts meet. Directions, affine maps and mean modes may come from
//! any heuristic in any precision; only the last evaluation is rounded with care.

mod affine;
mod cluster;
mod cone;
mod contact;
mod direction;
mod lanes;
mod leaf_pair;
mod min_norm;
mod path;
#[cfg(test)]
mod reference;
#[cfg(test)]
mod rounding_tests;
mod scaled;
#[cfg(test)]
mod tests;
mod triangle_pair;

pub(crate) use cluster::{ClusterBounds, ClusterScratch, cluster_pair};
pub(crate) use direction::{TrianglePair, direction_bound};
pub(crate) use leaf_pair::LeafPair;
pub(crate) use min_norm::nearest_to_origin;
pub(crate) use path::Path;
pub(crate) use scaled::{DOWN, GapError, ScaledModel, direction, norm_up};
pub(crate) use triangle_pair::{PairRefiner, Target};
