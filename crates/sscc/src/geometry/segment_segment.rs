//! The exact intersection test of two closed segments in space.

use glam::DVec3;

use super::orientation::orient3d;
use super::planar::{AXES, intersect_segment_segment_2d, project};

/// Whether two closed segments, each of which may be a point, have a point in common.
///
/// Segments that meet are in one plane and meet in every projection. Conversely, if the four ends are in
/// one plane, some coordinate projection is injective on what they span (the plane, a line or a point),
/// and if the segments meet there then they meet in space. The test takes all three projections; those
/// that are not injective do not change the result.
pub(super) fn intersect_segment_segment(a: [DVec3; 2], b: [DVec3; 2]) -> bool {
    let meet_along =
        |axis| intersect_segment_segment_2d(a.map(|p| project(p, axis)), b.map(|p| project(p, axis)));
    AXES.into_iter().all(meet_along) && orient3d(a[0], a[1], b[0], b[1]) == 0
}
