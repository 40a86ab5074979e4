//! `GivenMotion`: given positions as the vertex motion of a [`Detector`](crate::Detector).
//!
//! Given positions are exact, so that the error in single precision is only that of the map to the frame: the centre of the
//! frame lies in the AABB of all positions, so mapped coordinates are within [-2, 2], and each is rounded by at most 2 units
//! of 2^-24. The separating-axis test allows for larger errors.

use glam::DVec3;

use crate::detect::layout::Layout;
use crate::detect::vertex_motion::VertexMotion;
use crate::geometry::Aabb;

/// The positions of all vertices of the mesh at each of `E` configurations.
#[derive(Clone, Copy)]
pub(super) struct GivenMotion<'x, const E: usize> {
    positions: [&'x [DVec3]; E],
    whole: Aabb,
    /// The distance by which boxes are widened.
    margin: f64,
}

impl<'x, const E: usize> GivenMotion<'x, E> {
    /// Creates the motion. The caller has checked the number of vertices and that positions are within limits.
    pub(super) fn new(positions: [&'x [DVec3]; E], layout: &Layout) -> Self {
        let used = layout.vertices.mesh_vertices();
        let of = |x: &[DVec3]| Aabb::of_points(used.iter().map(|v| x[*v as usize]));
        let whole = positions.iter().fold(Aabb::EMPTY, |all, x| all.union(&of(x)));
        Self { positions, whole, margin: 0.0 }
    }

    /// Returns the AABB of all positions.
    pub(super) fn aabb(&self) -> Aabb {
        self.whole
    }

    /// Returns the same motion, in the frame of a larger AABB.
    pub(super) fn in_frame_of(self, whole: Aabb) -> Self {
        Self { whole, ..self }
    }

    /// Returns the same motion with widened boxes, so that those of triangles nearer than a distance overlap: by half of the distance,
    /// but by no more than the extent, at which all boxes overlap.
    pub(super) fn widened(self, distance: f64) -> Self {
        let extent = (self.whole.upper - self.whole.lower).max_element();
        Self { margin: with_mutant!((distance / 2.0).min(extent), ClearanceHalved, distance / 4.0), ..self }
    }
}

impl<const E: usize> VertexMotion<E> for GivenMotion<'_, E> {
    const HAS_ERROR_BOUND: bool = true;

    /// Returns the margin. Given positions are exact, so it is 0 unless boxes are widened.
    #[inline]
    fn rounding(&self) -> f64 {
        with_mutant!(self.margin, ClearanceOfBoxesAlone, 0.0)
    }

    #[inline]
    fn margin(&self) -> f64 {
        self.margin
    }

    #[inline]
    fn overall_aabb(&self, _: &Layout) -> Aabb {
        self.whole
    }

    #[inline]
    fn coarse_coordinates(&self) -> Option<[&[f64]; E]> {
        None
    }

    #[inline]
    fn coarse_slack(&self, _: u32) -> Option<DVec3> {
        None
    }

    #[inline]
    fn positions(&self, layout: &Layout, vertex: u32) -> [DVec3; E] {
        let vertex = layout.vertices.mesh_vertex(vertex) as usize;
        self.positions.map(|x| x[vertex])
    }

    /// Returns `None`, because boxes of nodes are refitted.
    #[inline]
    fn node_aabb(&self, _: &Layout, _: u32) -> Option<Aabb> {
        None
    }
}
