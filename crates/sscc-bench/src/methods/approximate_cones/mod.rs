//! Normal cones without the contour test, as the paper's section 7 compares with them: **collisions may be missed**.
//!
//! The traditional method that does not look into a node whose normals are all on the positive side of one of 14
//! directions. A patch of the surface that passes this test can still meet itself (a ramp that winds over itself), which
//! the contour test of [`sscc::Method::NormalCones`] excludes. Normals at both ends say nothing about the motion between
//! them: continuous queries are those of the traditional method.

mod aabb8;
mod directions;
mod query;
#[cfg(test)]
mod tests;
mod volumes;

pub use query::ApproximateCones;
