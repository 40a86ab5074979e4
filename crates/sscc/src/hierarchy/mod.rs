//! The bounding volume hierarchy (BVH) over the triangles: 4-ary, by k-means on rest positions and modes (paper, section
//! 3).

mod build;
mod features;
#[allow(clippy::module_inception)] // named after its type, as all files here
mod hierarchy;
mod k_means;
mod node;
mod split;
mod validate;

pub use hierarchy::Hierarchy;
pub(crate) use node::BUCKET_TRIANGLES;
pub use node::Node;
