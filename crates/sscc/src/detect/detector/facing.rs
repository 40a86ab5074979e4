//! Whether the triangles of a closed mesh face outward or inward.

use glam::DVec3;

use super::enclosed::Side;
use crate::Error;

/// Error of a term of a component's volume, over the product of its three lengths: differences, a cross and a dot product, less than 12
/// units of 2^-53 of 16.
const ERROR: f64 = 8.0 * f64::EPSILON;

/// Returns 1 for a mesh that faces outward, -1 for one that faces inward. Returns `None` if the winding number about some points has
/// the opposite sign, so that the mesh has no inside. Components without volume do not count. The sign of its volume determines how
/// a component that crosses itself faces. `triangles`: the corners of all triangles.
///
/// # Errors
/// When the token cancels.
pub(super) fn facing(side: &Side<'_>, triangles: &[[DVec3; 3]]) -> Result<Option<i32>, Error> {
    let components = side.components;
    let from: Vec<(u32, DVec3)> = components.triangles().map(|t| (t, triangles[t as usize][0])).collect();
    // For each component six times its volume, and a bound of its rounding errors.
    let mut volumes = vec![[0.0_f64; 2]; from.len()];
    for (triangle, corners) in triangles.iter().enumerate() {
        let component = components.of_triangle(triangle as u32);
        let [a, b, c] = corners.map(|p| p - from[component].1);
        let [volume, error] = &mut volumes[component];
        *volume += a.dot(b.cross(c));
        *error += ERROR * (a.length() * b.length() * c.length()) + f64::EPSILON * volume.abs();
    }
    let direction = if volumes.iter().map(|[volume, _]| volume).sum::<f64>() < 0.0 { -1 } else { 1 };
    for (&(triangle, point), [volume, error]) in from.iter().zip(volumes) {
        if volume.abs() <= with_mutant!(error, FlatPartsFace, 0.0) {
            continue;
        }
        let own = components.of_triangle(triangle);
        let outside = side.winding_number_of(point, |t| components.of_triangle(t) != own)?;
        let inside = outside + if volume < 0.0 { -1 } else { 1 };
        if with_mutant!(outside * direction < 0 || inside * direction < 0, PartsFaceAnyWay, false) {
            return Ok(None);
        }
    }
    Ok(Some(direction))
}
