//! The common points of two triangles, with the features on which these lie, and the smallest translation that separates the two
//! triangles. All decisions are exact; only positions, normals and depths are rounded.

mod corner_order;
mod crossing_point;
mod feature;
mod hull;
mod normal;
mod penetration;
mod triangle_contact;
mod triangle_triangle;

pub use feature::{Feature, Intersection, IntersectionPoint};
pub use penetration::{Penetration, penetration_triangle_triangle};
pub(crate) use triangle_contact::TriangleContact;
pub use triangle_triangle::intersection_triangle_triangle;
