//! Normal cones without the contour test, as the paper's section 7 compares with them: **collisions may be missed**.
//!
//! The traditional method, without tests within a node whose normals are all on the positive side of one of 14
//! directions. A patch of the surface that passes this test can still intersect itself (a ramp that winds over itself).
//! The contour test of [`sscc::Method::NormalCones`] excludes this case. Normals at both ends of a motion prove nothing
//! about the motion between them, so continuous queries are those of the traditional method.

mod aabb8;
mod directions;
mod query;
#[cfg(test)]
mod tests;
mod volumes;

pub use query::ApproximateCones;
