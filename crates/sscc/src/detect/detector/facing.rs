//! Whether the triangles of a closed mesh face outward or inward.

use glam::DVec3;

use super::enclosed::Side;
use crate::Error;

/// Error of a term of a part's volume, over the product of its three lengths: differences, a cross and a dot product, less than 12
/// units of 2^-53 of 16.
const ERROR: f64 = 8.0 * f64::EPSILON;

/// The number of triangles of a part, spread over it, that tell where it is. Rounding decides where triangles are that lie on other
/// parts, so one triangle would not suffice.
const TRIANGLES_TRIED: usize = 16;

/// A part of a mesh: triangles joined by common edges.
struct Part {
    /// A corner. Volumes are relative to it.
    origin: DVec3,
    /// Six times the volume, and a bound of its rounding errors.
    volume: [f64; 2],
    triangles: Vec<u32>,
}

/// Returns 1 for a mesh that faces outward, -1 for one that faces inward. Returns `None` if the winding number about some points has
/// the opposite sign, so that the mesh has no inside. Parts without volume do not count. The sign of its volume determines how
/// a part that crosses itself faces. `triangles`: the corners of all triangles of the closed mesh.
///
/// # Errors
/// When the token cancels.
pub(super) fn facing(side: &Side<'_>, triangles: &[[DVec3; 3]]) -> Result<Option<i32>, Error> {
    let of_triangles = side.components.parts();
    let mut parts: Vec<Part> = Vec::new();
    for (triangle, (corners, number)) in triangles.iter().zip(of_triangles).enumerate() {
        if *number as usize == parts.len() {
            parts.push(Part { origin: corners[0], volume: [0.0; 2], triangles: Vec::new() });
        }
        let part = &mut parts[*number as usize];
        let [a, b, c] = corners.map(|p| p - part.origin);
        let [volume, error] = &mut part.volume;
        *volume += a.dot(b.cross(c));
        *error += ERROR * (a.length() * b.length() * c.length()) + f64::EPSILON * volume.abs();
        part.triangles.push(triangle as u32);
    }
    let direction = if parts.iter().map(|part| part.volume[0]).sum::<f64>() < 0.0 { -1 } else { 1 };
    for (number, part) in parts.iter().enumerate() {
        let [volume, error] = part.volume;
        if volume.abs() <= with_mutant!(error, FlatPartsFace, 0.0) {
            continue;
        }
        let is_of_others = |t: u32| of_triangles[t as usize] as usize != number;
        let step = part.triangles.len().div_ceil(TRIANGLES_TRIED);
        let mut windings = Vec::with_capacity(TRIANGLES_TRIED);
        for t in part.triangles.iter().step_by(step) {
            let [a, b, c] = triangles[*t as usize];
            let point = with_mutant!((a + b + c) / 3.0, PointsAtOrigins, part.origin);
            windings.push(side.winding_number_of(point, is_of_others)?);
        }
        windings.sort_unstable();
        // All are equal, except for triangles that lie on other parts or beyond a crossing.
        let outside = windings[windings.len() / 2];
        let inside = outside + if volume < 0.0 { -1 } else { 1 };
        if with_mutant!(outside * direction < 0 || inside * direction < 0, PartsFaceAnyWay, false) {
            return Ok(None);
        }
    }
    Ok(Some(direction))
}
