//! Exact intersection tests of closed shapes, named `intersect_shape_shape`.
//!
//! Every shape is the convex hull of its corners, touching counts, and the answer is that of exact
//! arithmetic on the given `f64` coordinates: never a tolerance, never a rounding. This holds for
//! coordinates up to [`limits::LARGEST`](crate::limits::LARGEST), down to the smallest denormal.
//!
//! All tests are Boolean formulas over comparisons of coordinates and signs of determinants
//! ([`orientation`]); only those signs need arithmetic. Most are settled in a few dozen
//! floating-point operations with a proven error bound, the rest exactly ([`exact`]).

mod beyond_vertex;
mod exact;
mod orientation;
mod planar;
mod segment_segment;
mod segment_triangle;
mod triangle_triangle;

pub use beyond_vertex::intersect_beyond_vertex;
pub(crate) use exact::decode;
pub use triangle_triangle::intersect_triangle_triangle;
