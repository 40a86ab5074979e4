//! The size of a body: the size in its file, a factor on it, a unit of its lengths, or a given longest side.

use glam::DVec3;
use sscc::TriMesh;

use crate::TaskError;

/// Units of length of files, with their lengths in metres.
pub const UNITS: [(&str, f64); 4] = [("mm", 0.001), ("cm", 0.01), ("m", 1.0), ("in", 0.0254)];

/// The size of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Resize {
    /// The size in its files.
    #[default]
    Keep,
    /// All lengths of its files are multiplied by this factor.
    Factor(f64),
    /// The longest side of its AABB (m).
    LongestSide(f64),
}

impl Resize {
    /// Returns the factor on all lengths, for a body with these vertices.
    ///
    /// # Errors
    /// When the factor is not positive and finite, such as for a longest side if all points are equal.
    pub fn factor(self, points: &[DVec3]) -> Result<f64, TaskError> {
        let (key, factor) = match self {
            Self::Keep => return Ok(1.0),
            Self::Factor(factor) => ("scale", factor),
            Self::LongestSide(size) => ("size", size / longest_side(points)),
        };
        if factor.is_finite() && factor > 0.0 {
            return Ok(factor);
        }
        Err(TaskError::refused(key, "this shape cannot be scaled so: it has no extent"))
    }
}

/// Returns the longest side of the AABB of points; 0 if there are no points.
pub fn longest_side(points: &[DVec3]) -> f64 {
    let Some(first) = points.first() else { return 0.0 };
    let (lower, upper) = points.iter().fold((*first, *first), |(a, b), p| (a.min(*p), b.max(*p)));
    (upper - lower).max_element()
}

/// Returns the mesh with all lengths multiplied by the factor.
///
/// # Errors
/// When a coordinate is then out of range.
pub fn scaled(mesh: TriMesh, factor: f64) -> Result<TriMesh, TaskError> {
    if factor == 1.0 {
        return Ok(mesh);
    }
    let points = mesh.rest_positions().iter().map(|p| *p * factor).collect();
    Ok(mesh.with_rest_positions(points)?)
}
