//! Geometry of boxes and triangles: AABBs, exact intersection tests, nearest points, continuous tests of moving triangles
//! ([`ccd`]).
//!
//! Intersection tests are named `intersect_shape_shape`; functions that return the common points are named
//! `intersection_shape_shape` ([`intersection`]). Every shape is the closed convex hull of its corners, so touching
//! counts, and the answer is that of exact arithmetic on the given f64 coordinates. This holds for coordinates up to
//! [`limits::LARGEST`](crate::limits::LARGEST), down to the smallest denormal number.
//!
//! All tests are Boolean formulas over comparisons of coordinates and signs of determinants ([`orientation`]). A
//! floating-point filter with a proven error bound decides most signs, exact arithmetic ([`exact_orientation`]) the
//! others.

mod aabb;
mod binary64;
pub(crate) mod ccd;
mod crossing;
mod double_double;
mod exact_orientation;
mod intersection;
mod nearest_point;
mod orientation;
mod overlap_integral;
mod planar;
mod point_distance;
mod segment_segment;
mod segment_triangle;
mod shared_edge;
mod shared_vertex;
mod triangle_distance;
mod triangle_triangle;
mod two_triangles;

pub use aabb::Aabb;
pub(crate) use ccd::free_until;
pub use ccd::{MovingTriangle, impact_edge_edge, impact_triangle_triangle, impact_vertex_face};
pub(crate) use crossing::crossing;
pub(crate) use intersection::TriangleContact;
pub use intersection::{
    Feature, Intersection, IntersectionPoint, Penetration, intersection_triangle_triangle,
    penetration_triangle_triangle,
};
pub(crate) use nearest_point::{nearest_to_origin, nearest_within};
pub use orientation::orient2d;
pub(crate) use overlap_integral::overlap_integral;
pub(crate) use point_distance::distance_point_triangle;
pub use shared_edge::intersect_shared_edge_pair;
pub use shared_vertex::intersect_shared_vertex_pair;
pub use triangle_distance::{DISTANCE_ERROR, distance_triangle_triangle};
pub use triangle_triangle::intersect_triangle_triangle;
pub(crate) use two_triangles::TwoTriangles;
