//! Points and triangles as plain numbers.

/// A point.
pub type Point = [f64; 3];

/// The corners of a triangle.
pub type Triangle = [Point; 3];
