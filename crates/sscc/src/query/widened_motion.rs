//! The vertex motion of searches for near triangles at q: positions deformed by the modes, and wider AABBs.

use glam::DVec3;

use crate::detect::layout::Layout;
use crate::detect::vertex_motion::{DeformedMotion, VertexMotion};
use crate::geometry::Aabb;

/// A motion to q with widened AABBs: those of triangles nearer than a clearance overlap.
#[derive(Clone, Copy)]
pub(super) struct WidenedMotion<'q> {
    motion: DeformedMotion<'q, 1>,
    whole: Aabb,
    margin: f64,
}

/// AABBs are also widened by this share of the extent, for rounding. Distances are computed within 2^-40 of the size of
/// two triangles, and coordinates in the frame of a search are rounded to a few units of 2^-24 of the extent. Rounding
/// to single precision moves AABBs by as much.
const ROUNDING_SHARE: f64 = 4.0 * f32::EPSILON as f64;

impl<'q> WidenedMotion<'q> {
    /// Widens each AABB by half of `distance`, but by no more than the extent, at which all AABBs overlap, and by
    /// [`ROUNDING_SHARE`] of the extent.
    pub(super) fn new(motion: DeformedMotion<'q, 1>, layout: &Layout, distance: f64) -> Self {
        let whole = motion.overall_aabb(layout);
        let extent = (whole.upper - whole.lower).max_element();
        let half = with_mutant!(
            (distance / 2.0).min(extent),
            WidenedByHalfOfClearance,
            (distance / 4.0).min(extent)
        );
        Self {
            motion,
            whole,
            margin: half + with_mutant!(ROUNDING_SHARE, WidenedWithoutRounding, 0.0) * extent,
        }
    }
}

impl VertexMotion<1> for WidenedMotion<'_> {
    const HAS_ERROR_BOUND: bool = true;

    #[inline]
    fn rounding(&self) -> f64 {
        self.motion.rounding()
    }

    #[inline]
    fn margin(&self) -> f64 {
        self.margin
    }

    #[inline]
    fn margin_beside_rounding(&self) -> f64 {
        self.margin
    }

    #[inline]
    fn overall_aabb(&self, _: &Layout) -> Aabb {
        self.whole
    }

    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; 1]> {
        self.motion.coarse_coordinates()
    }

    #[inline]
    fn coarse_slack(&self, _: u32) -> Option<DVec3> {
        Some(DVec3::splat(with_mutant!(self.margin, CoarseBoxesOfClearanceNotWidened, 0.0)))
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; 1] {
        self.motion.positions(layout, vertex)
    }

    #[inline]
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb> {
        let Aabb { lower, upper } = self.motion.node_aabb(layout, node)?;
        let margin = with_mutant!(self.margin, NodesOfClearanceNotWidened, 0.0);
        Some(Aabb { lower: lower - margin, upper: upper + margin })
    }
}
