//! Axis-aligned boxes in double precision, for single pairs of triangles.

use glam::DVec3;

/// An axis-aligned box: lower and upper corner.
pub(super) type Aabb = (DVec3, DVec3);

/// Whether two boxes have no point in common. NaN counts as overlap.
#[inline]
pub(super) fn disjoint(a: &Aabb, b: &Aabb) -> bool {
    (a.0.cmpgt(b.1) | b.0.cmpgt(a.1)).any()
}

/// The box of three points.
#[inline]
pub(super) fn triangle_box([a, b, c]: [DVec3; 3]) -> Aabb {
    (a.min(b).min(c), a.max(b).max(c))
}

/// The box around a triangle at each end of its way.
#[inline]
pub(super) fn around<const E: usize>(corners: &[[DVec3; 3]; E]) -> Aabb {
    let ends = corners.map(triangle_box);
    ends.into_iter().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
}
