//! The motion of vertices in one search: the source of positions and AABBs, over which searches are generic.
//!
//! A search has `E` configurations: one, or the start and the end of a motion. There are five sources, dispatched
//! statically: positions deformed by modes ([`DeformedMotion`]), the same with wider AABBs
//! ([`WidenedMotion`](crate::query)), all positions in a capsule of configurations ([`CapsuleMotion`](crate::query)),
//! deformed positions in the world ([`PosedMotion`](crate::posed)), and given positions
//! ([`Detector`](crate::Detector)).

use glam::{DMat3, DVec3};

use super::layout::Layout;
use crate::geometry::Aabb;

/// Positions and AABBs at the `E` configurations of a search.
pub(crate) trait VertexMotion<const E: usize> {
    /// Whether mapped positions are within a known bound of the exact ones, so that triangles can be separated in single
    /// precision. Then [`Self::overall_aabb`] must contain all positions.
    const HAS_ERROR_BOUND: bool;

    /// Returns an upper bound, along each axis, of the rounding error of positions and of AABBs in double precision,
    /// plus [`Self::margin`] without [`Self::margin_beside_rounding`].
    fn rounding(&self) -> f64;

    /// Returns the distance by which all AABBs are widened, to find near triangles.
    fn margin(&self) -> f64 {
        0.0
    }

    /// Returns the part of [`Self::margin`] that [`Self::rounding`] does not include. It would exceed the allowed error of coarse
    /// positions by far, so [`Self::coarse_slack`] includes it and widens their AABBs.
    fn margin_beside_rounding(&self) -> f64 {
        0.0
    }

    /// Returns the AABB that determines the [`F32Frame`](super::f32_frame::F32Frame). It must contain the positions at
    /// [`Self::coarse_coordinates`], and all positions if [`Self::HAS_ERROR_BOUND`], because the error bounds assume that.
    /// For other sources any AABB is valid, and affects speed only.
    fn overall_aabb(&self, layout: &Layout) -> Aabb;

    /// Returns the reduced coordinates from which coarse positions may be computed; `None` if positions must be exact.
    fn coarse_coordinates(&self) -> Option<[&[f64]; E]>;

    /// Returns the largest distance in z of configurations of the motion from the segment between
    /// [`Self::coarse_coordinates`]; `None` if positions are not those of the modes alone.
    fn region_radius(&self) -> Option<f64> {
        None
    }

    /// Returns the pose of a shape in the world; `None` for positions in axes of the model.
    fn in_world(&self) -> Option<InWorld<E>> {
        None
    }

    /// Returns a bound, along each axis, of the distance of the vertices of a node from their positions at
    /// [`Self::coarse_coordinates`], plus [`Self::margin_beside_rounding`]; `None` if the sum is 0.
    fn coarse_slack(&self, node: u32) -> Option<DVec3>;

    /// Returns the exact positions of a vertex, by its index in the layout.
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; E];

    /// Returns an AABB of all positions of a node's vertices, computed without these positions; `None` for a node without such an AABB.
    fn node_aabb(&self, layout: &Layout, node: u32) -> Option<Aabb>;
}

/// The pose of a shape in the world.
pub(crate) struct InWorld<const E: usize> {
    /// The matrix and the translation of `x -> matrix x + translation` at each configuration.
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
    /// Creates the motion. `reach`: an upper bound of the magnitude of every term of every position, at each configuration.
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

/// Returns an upper bound of the rounding error of BD-tree AABBs and positions. It is well above the 2 (r + 1) roundings of each.
pub(crate) fn rounding_bound(reach: f64, rank: usize) -> f64 {
    with_mutant!(reach * ((4 * rank + 64) as f64 * f64::EPSILON) + f64::MIN_POSITIVE, BoxesNotWidened, 0.0)
}
