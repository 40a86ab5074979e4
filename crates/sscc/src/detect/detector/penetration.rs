//! The penetration of two closed meshes: their shared volume, and the largest ball inside of both.

use super::boxes::Boxes;
use super::common_ball::largest_common_ball;
use super::detector::Detector;
use super::enclosed::Side;
use super::facing::facing;
use super::shared_volume::shared_volume;
use crate::Error;
use glam::DVec3;

/// The penetration of two closed meshes, as solid bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BodyPenetration {
    /// The volume that is inside of both meshes, within `volume_error`. If a mesh crosses itself, volume counts as often as its winding
    /// number.
    pub volume: f64,
    /// Bound of the rounding error of the volume.
    pub volume_error: f64,
    /// The diameter of a ball that is inside of both meshes and meets no triangle, nearly the largest one; 0 if there
    /// is no ball, or the volume is not larger than its error. For two overlapping plates or balls, it is the distance
    /// by which one must move to separate them.
    pub depth: f64,
    /// No such ball has a larger diameter than `depth + depth_error`, up to 1e-9 of the size of the meshes. The error is at most a
    /// thousandth of the depth, unless the shared volume is thinner, across all axes, than about a hundredth of its width.
    pub depth_error: f64,
}

/// Returns the volume that two meshes share, and the diameter of the largest ball inside of both, each mesh at its positions. The cost
/// is that of the pairs of triangles whose projections along z overlap, and of a search that takes longer for a flatter shared volume.
/// The token of the first detector cancels it, and so does that of the second, except in the sum of the volume.
///
/// # Errors
/// As [`Detector::discrete_at_most`], for the positions of both meshes; when a mesh is open, or has parts (triangles
/// joined by common edges) that face inward and are not within others, so that it has no inside.
pub fn body_penetration(
    [one, two]: [&mut Detector; 2],
    [positions, other_positions]: [&[DVec3]; 2],
) -> Result<BodyPenetration, Error> {
    one.check([positions])?;
    two.check([other_positions])?;
    let found = penetration_of_any_size([&mut *one, two], [positions, other_positions]);
    one.statistics.finish(found)
}

/// Lengths are scaled by this factor while all coordinates are smaller than [`SMALL`].
const SCALE: f64 = f64::from_bits((1023 + 300) << 52);

/// 2^-100: fourth powers of lengths at this size do not underflow.
const SMALL: f64 = f64::from_bits((1023 - 100) << 52);

/// Returns the penetration as [`body_penetration`], at positions that were checked. Very small meshes are scaled by a power of two, since
/// products of their lengths would underflow.
fn penetration_of_any_size(
    detectors: [&mut Detector; 2],
    positions: [&[DVec3]; 2],
) -> Result<BodyPenetration, Error> {
    let used = detectors.each_ref().map(|detector| detector.context.filter.faces().as_flattened());
    let corners = used.iter().zip(positions).flat_map(|(used, x)| used.iter().map(|v| x[*v as usize]));
    let mut largest = corners.map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let mut scalings = 0;
    while largest > 0.0 && with_mutant!(largest < SMALL, SmallBodiesNotScaled, false) {
        largest *= SCALE;
        scalings += 1;
    }
    if scalings == 0 {
        return penetration(detectors, positions);
    }
    let times = |x: f64, factor: f64, count: u32| (0..count).fold(x, |x, _| x * factor);
    let scaled = positions.map(|x| {
        let scale = |p: &DVec3| DVec3::from_array(p.to_array().map(|x| times(x, SCALE, scalings)));
        x.iter().map(scale).collect::<Vec<_>>()
    });
    let found = penetration(detectors, scaled.each_ref().map(Vec::as_slice))?;
    // Results may underflow: their errors are rounded up.
    let (length, volume) =
        (|x: f64| times(x, 1.0 / SCALE, scalings), |x: f64| times(x, 1.0 / SCALE, 3 * scalings));
    let least = f64::from_bits(1);
    Ok(BodyPenetration {
        volume: volume(found.volume),
        volume_error: volume(found.volume_error) + least,
        depth: length(found.depth),
        depth_error: length(found.depth_error) + least,
    })
}

/// Returns the penetration as [`body_penetration`], at positions that were checked.
fn penetration(
    [one, two]: [&mut Detector; 2],
    [positions, other_positions]: [&[DVec3]; 2],
) -> Result<BodyPenetration, Error> {
    let components = [one.components_at(positions), two.components_at(other_positions)];
    if let Some(open) = components.iter().position(|components| !components.are_closed()) {
        return Err(Error::OpenMesh(["first", "second"][open]));
    }
    let boxes = [Boxes::new(&one.context, positions), Boxes::new(&two.context, other_positions)];
    let triangles = boxes.each_ref().map(|boxes| {
        let faces = boxes.context.filter.faces().len() as u32;
        (0..faces).map(|triangle| boxes.corners(triangle)).collect::<Vec<_>>()
    });
    let cancel = one.context.cancel.as_ref();
    let [a, b] = boxes;
    let sides =
        [&Side { boxes: a, components: &components[0] }, &Side { boxes: b, components: &components[1] }];
    let mut directions = [1; 2];
    for (n, name) in ["first", "second"].into_iter().enumerate() {
        directions[n] = facing(sides[n], &triangles[n])?.ok_or(Error::OpenMesh(name))?;
    }
    let sign = f64::from(directions[0] * directions[1]);
    let (volume, volume_error) = shared_volume(triangles.each_ref().map(Vec::as_slice), sign, cancel)?;
    // The volume of the ball is at most the shared volume. If that may be 0, as for meshes that only touch, no ball is searched.
    let largest = (0.75 * (volume + volume_error) / std::f64::consts::PI).cbrt();
    let (radius, bound) = if volume <= volume_error { (0.0, largest) } else { largest_common_ball(sides)? };
    let bound = bound.min(largest).max(radius);
    Ok(BodyPenetration { volume, volume_error, depth: 2.0 * radius, depth_error: 2.0 * (bound - radius) })
}
