//! Exact intersection tests of closed shapes, named `intersect_shape_shape`.
//!
//! Every shape is the convex hull of its corners, touching counts, and the answer is that of exact
//! arithmetic on the given `f64` coordinates: never a tolerance, never a rounding. This holds for
//! coordinates up to [`limits::LARGEST`](crate::limits::LARGEST), down to the smallest denormal.
//!
//! All tests are Boolean formulas over comparisons of coordinates and signs of determinants
//! ([`orientation`]); only those signs need arithmetic. Most are settled in a few dozen
//! floating-point operations with a proven error bound, the rest exactly ([`exact`]).

mod aabb;
pub(crate) mod ccd;
mod exact;
mod nearest_point;
mod orientation;
mod planar;
mod segment_segment;
mod segment_triangle;
mod shared_vertex;
mod triangle_triangle;

pub use aabb::Aabb;
pub use ccd::{MovingTriangle, impact_edge_edge, impact_triangle_triangle, impact_vertex_face};
pub(crate) use exact::decode;
pub(crate) use nearest_point::nearest_to_origin;
pub use shared_vertex::intersect_beyond_vertex;
pub use triangle_triangle::intersect_triangle_triangle;
