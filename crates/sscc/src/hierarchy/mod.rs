//! The bounding volume hierarchy (BVH) over the triangles: 4-ary; for certificates by k-means on rest positions and modes
//! (paper, section 3), for detectors by median splits.

mod build;
mod cluster_features;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod hierarchy;
mod k_means;
mod median_split;
mod node;
mod node_pair;
mod split;
mod validation;

pub use hierarchy::Hierarchy;
pub use node::Node;
pub(crate) use node::{BRANCHING, BUCKET_TRIANGLES, PACKET_TRIANGLES};
pub(crate) use node_pair::NodePair;
