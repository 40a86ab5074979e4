//! Deformed positions in the world: the vertex motion of posed shapes.

use glam::DVec3;

use super::pose::Pose;
use crate::detect::layout::Layout;
use crate::detect::vertex_motion::{VertexMotion, rounding_bound};
use crate::geometry::Aabb;

/// A shape at some q and pose.
#[derive(Clone)]
pub(super) struct PosedMotion {
    pub(super) q: Vec<f64>,
    pub(super) pose: Pose,
    /// An AABB of approximately all shapes compared.
    pub(super) around: Aabb,
    /// An upper bound of the magnitude of every term of every position in the world.
    pub(super) reach: f64,
}

impl VertexMotion<1> for PosedMotion {
    const HAS_ERROR_BOUND: bool = false;

    #[inline]
    fn rounding(&self) -> f64 {
        rounding_bound(self.reach, self.q.len())
    }

    fn overall_aabb(&self, _: &Layout) -> Aabb {
        self.around
    }

    /// Coordinates in the world have no bound, so positions are exact.
    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; 1]> {
        None
    }

    #[inline]
    fn coarse_slack(&self, _: u32) -> Option<DVec3> {
        None
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; 1] {
        layout.vertices.position(vertex, [&self.q]).map(|x| self.pose.apply(x))
    }

    #[inline]
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb> {
        let rounding = self.rounding();
        let own = layout.bd_tree.at(node, [&self.q], DVec3::splat(rounding));
        own.map(|aabb| self.pose.apply_to_aabb(aabb, rounding))
    }
}
