//! The AABBs of the meshes of a scene: two meshes whose AABBs are apart need no query.

use sscc::parts::Aabb;

use super::worker::Side;

/// Returns the AABB of each mesh over the motion that the sides have read.
pub(super) fn boxes(sides: &[Side<'_, '_>]) -> Vec<Aabb> {
    sides.iter().map(|side| Aabb::of_points(side.x_t0.iter().chain(&side.x_t1).copied())).collect()
}

/// Whether two AABBs are farther apart along an axis than a distance. No collision is missed: a difference that is at most
/// the distance also rounds to at most the distance, because rounding is monotone.
pub(super) fn are_apart(a: &Aabb, b: &Aabb, distance: f64) -> bool {
    let is_beyond = |low: f64, high: f64| low - high > distance;
    (0..3).any(|k| is_beyond(a.lower[k], b.upper[k]) || is_beyond(b.lower[k], a.upper[k]))
}
