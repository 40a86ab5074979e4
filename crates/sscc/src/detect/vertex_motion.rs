//! The motion of vertices in one search: the source of positions and AABBs, over which the detector is generic.
//!
//! A search has `E` configurations: one, or the start and the end of a motion. Sources are dispatched statically:
//! positions deformed by modes ([`DeformedMotion`]), all positions in a capsule of configurations
//! ([`CapsuleMotion`](crate::query)), deformed positions in the world ([`PosedMotion`](crate::posed)), and
//! given positions ([`Detector`](crate::Detector)).

use glam::{DMat3, DVec3};

use super::layout::Layout;
use crate::geometry::Aabb;

/// Positions and AABBs at the `E` configurations of a search.
pub(crate) trait VertexMotion<const E: usize> {
    /// Whether mapped positions are within a known bound of the exact ones, so that triangles can be separated in single
    /// precision. Then [`Self::overall_aabb`] must contain all positions.
    const HAS_ERROR_BOUND: bool;

    /// An upper bound, along each axis, of the rounding error of positions and of AABBs in double precision.
    fn rounding(&self) -> f64;

    /// The distance by which all AABBs are widened, to find near triangles. [`Self::rounding`] includes it.
    fn margin(&self) -> f64 {
        0.0
    }

    /// The part of [`Self::margin`] that [`Self::rounding`] does not include. Coarse positions have a bound of their error, which that
    /// part would exceed by far: there [`Self::coarse_slack`] widens AABBs.
    fn margin_beside_rounding(&self) -> f64 {
        0.0
    }

    /// The AABB that chooses the [`F32Frame`](super::f32_frame::F32Frame). It must contain the positions at
    /// [`Self::coarse_coordinates`], and all positions where [`Self::HAS_ERROR_BOUND`]: the error bounds assume that. For
    /// other sources any AABB is right, and affects speed only.
    fn overall_aabb(&self, layout: &Layout) -> Aabb;

    /// The reduced coordinates from which coarse positions may be computed; none if positions must be exact.
    fn coarse_coordinates(&self) -> Option<[&[f64]; E]>;

    /// The distance in z within which all configurations of the motion are around the segment between
    /// [`Self::coarse_coordinates`]; none where positions are not those of the modes alone.
    fn region_radius(&self) -> Option<f64> {
        None
    }

    /// Where a shape in the world is; none for positions in axes of the model.
    fn in_world(&self) -> Option<InWorld<E>> {
        None
    }

    /// How far, along each axis, the vertices of a node may be from their positions at these coordinates; none: not at
    /// all.
    fn coarse_slack(&self, node: u32) -> Option<DVec3>;

    /// The exact positions of a vertex, by its index in the layout.
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; E];

    /// An AABB of all positions of a node's vertices, computed without them; none for a node that has no such AABB.
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb>;
}

/// Where a shape is in the world.
pub(crate) struct InWorld<const E: usize> {
    /// At each configuration the matrix and the translation of `x -> matrix x + translation`.
    pub(crate) maps: [(DMat3, DVec3); E],
    /// The bound of [`VertexMotion::rounding`] for positions in axes of the model.
    pub(crate) own_rounding: f64,
}

/// Positions deformed by the modes: at q, or on straight lines from one q to another.
#[derive(Clone, Copy)]
pub(crate) struct DeformedMotion<'q, const E: usize> {
    q: [&'q [f64]; E],
    rounding: f64,
}

impl<'q, const E: usize> DeformedMotion<'q, E> {
    /// `reach`: an upper bound of the magnitude of every term of every position, at each configuration.
    pub(crate) fn new(q: [&'q [f64]; E], reach: f64) -> Self {
        Self { q, rounding: rounding_bound(reach, q[0].len()) }
    }
}

impl<const E: usize> VertexMotion<E> for DeformedMotion<'_, E> {
    const HAS_ERROR_BOUND: bool = true;

    #[inline]
    fn rounding(&self) -> f64 {
        self.rounding
    }

    #[inline]
    fn overall_aabb(&self, layout: &Layout) -> Aabb {
        layout.bd_tree.root(self.q, DVec3::splat(self.rounding))
    }

    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; E]> {
        Some(self.q)
    }

    #[inline]
    fn region_radius(&self) -> Option<f64> {
        Some(0.0)
    }

    #[inline]
    fn coarse_slack(&self, _node: u32) -> Option<DVec3> {
        None
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; E] {
        layout.vertices.position(vertex, self.q)
    }

    #[inline]
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb> {
        layout.bd_tree.at(node, self.q, DVec3::splat(self.rounding))
    }
}

/// An upper bound of the rounding error of BD-tree AABBs and positions: well above the 2 (r + 1) roundings of each.
pub(crate) fn rounding_bound(reach: f64, rank: usize) -> f64 {
    right_or!(reach * ((4 * rank + 64) as f64 * f64::EPSILON) + f64::MIN_POSITIVE, BoxesNotWidened, 0.0)
}
