//! Coarse positions of vertices in one search, from quantized displacements, with a bound of their error.

use glam::{DVec3, Vec4};

use super::aabb8::AabbF32;
use super::f32_frame::F32Frame;
use super::frame_map::FrameMap;
use super::layout::Layout;
use super::quantization::CoarseMotion;
use super::vertex_motion::{InWorld, VertexMotion};

/// The coarse motion of a search, and the coarse positions of the vertices of open buckets.
#[derive(Clone)]
pub(crate) struct CoarsePositions<const E: usize> {
    /// Whether this search uses coarse positions; otherwise AABBs of triangles are computed from exact ones.
    is_used: bool,
    motion: CoarseMotion<E>,
    positions: Vec<[Vec4; E]>,
}

impl<const E: usize> CoarsePositions<E> {
    pub(crate) fn new(layout: &Layout) -> Self {
        let positions = layout.coarse.new_positions();
        Self { is_used: false, motion: CoarseMotion::default(), positions }
    }

    /// Starts a search in a frame: decides whether it uses coarse positions.
    pub(crate) fn begin<M: VertexMotion<E>>(&mut self, layout: &Layout, motion: &M, frame: &F32Frame) {
        self.is_used = self.begin_motion(layout, motion, frame);
    }

    /// Sets the coarse motion of a search. False if it must use exact positions.
    fn begin_motion<M: VertexMotion<E>>(&mut self, layout: &Layout, motion: &M, frame: &F32Frame) -> bool {
        let coarse = &mut self.motion;
        coarse.maps = None;
        let Some(q) = motion.coarse_coordinates().filter(|_| !layout.coarse.is_empty()) else { return false };
        let Some(InWorld { maps, own_rounding }) = motion.in_world() else {
            return layout.quantization.begin(coarse, q, frame, motion.rounding());
        };
        let own = F32Frame::around(layout.bd_tree.root(q, DVec3::splat(own_rounding)));
        if !layout.quantization.begin(coarse, q, &own, own_rounding) {
            return false;
        }
        let maps = maps.map(|map| FrameMap::new([&own, frame], map, coarse.error, motion.rounding()));
        if maps.iter().all(Option::is_some) {
            coarse.maps = Some(maps.map(Option::unwrap_or_default));
        }
        coarse.maps.is_some()
    }

    /// Whether this search uses coarse positions.
    #[inline]
    pub(crate) fn are_used(&self) -> bool {
        self.is_used
    }

    /// Returns the error bound of coarse positions in the frame of the search.
    #[inline]
    pub(crate) fn error(&self) -> f32 {
        self.motion.search_error()
    }

    /// Returns the BD-tree AABB of a node; `None` if this search uses exact positions, or the node has no such AABB.
    #[inline]
    pub(crate) fn node(&self, layout: &Layout, n: u32) -> Option<AabbF32> {
        if self.is_used { layout.bd_tree.coarse(n, &self.motion) } else { None }
    }

    /// Returns the slack of a node ([`VertexMotion::coarse_slack`]) in the frame, rounded up. The error of coarse
    /// positions comes in addition.
    #[inline]
    pub(crate) fn slack<M: VertexMotion<E>>(n: u32, motion: &M, frame: &F32Frame) -> Vec4 {
        motion.coarse_slack(n).map_or(Vec4::ZERO, |slack| {
            let slack = slack * (frame.scale() * (1.0 + 1e-5));
            // The slack must be finite, as are all corners of AABBs that are not empty.
            let slack = slack.as_vec3().extend(0.0).min(Vec4::MAX);
            with_mutant!(slack, CoarseSlackForgotten, Vec4::ZERO)
        })
    }

    /// Moves the vertices of a bucket.
    #[inline]
    pub(crate) fn move_bucket(&mut self, layout: &Layout, bucket: u32) {
        layout.coarse.move_bucket(bucket, &self.motion, &mut self.positions);
    }

    /// Returns the positions in the frame, of which those of moved buckets are current.
    #[inline]
    pub(crate) fn all(&self) -> &[[Vec4; E]] {
        &self.positions
    }

    /// Returns the vertices of a moved bucket, in the frame.
    pub(crate) fn of_bucket(&self, layout: &Layout, bucket: u32) -> &[[Vec4; E]] {
        layout.coarse.of_bucket(bucket, &self.positions)
    }
}
