//! Exact positions of vertices in one search, each computed at most once.

use glam::{DVec3, Vec4};

use super::aabb8::AabbF32;
use super::f32_frame::F32Frame;
use super::layout::Layout;
use super::vertex_motion::VertexMotion;
use crate::geometry::Aabb;

/// Positions in double precision and in the frame, each with the number of the search for which it is current.
#[derive(Clone)]
pub(crate) struct ExactPositions<const E: usize> {
    search: u32,
    frame: F32Frame,
    exact: Vec<[DVec3; E]>,
    mapped: Vec<[Vec4; E]>,
    searches: Vec<u32>,
}

impl<const E: usize> ExactPositions<E> {
    pub(crate) fn new(count: usize) -> Self {
        Self {
            search: 0,
            frame: F32Frame::default(),
            exact: vec![[DVec3::ZERO; E]; count],
            mapped: vec![[Vec4::ZERO; E]; count],
            searches: vec![0; count],
        }
    }

    /// Starts a search. `search`: its number, which is that after the last one, or 1, with which counting restarts.
    /// `overall_aabb` determines the frame.
    pub(crate) fn begin(&mut self, search: u32, overall_aabb: Aabb) {
        if search == 1 {
            self.searches.fill(0);
        }
        self.search = search;
        self.frame = F32Frame::around(overall_aabb);
    }

    /// Moves all vertices.
    pub(crate) fn move_all<M: VertexMotion<E>>(&mut self, layout: &Layout, motion: &M) {
        self.searches.fill(self.search);
        // Moving four vertices side by side was not faster: memory limits the speed.
        for (v, (x, mapped)) in self.exact.iter_mut().zip(&mut self.mapped).enumerate() {
            *x = motion.positions(layout, v as u32);
            *mapped = x.map(|x| self.frame.map(x));
            debug_assert!(!M::HAS_ERROR_BOUND || mapped.iter().all(|x| F32Frame::can_contain(*x)));
        }
    }

    /// Moves a vertex that has not been moved in this search.
    #[inline]
    pub(crate) fn move_vertex<M: VertexMotion<E>>(&mut self, layout: &Layout, vertex: u32, motion: &M) {
        let i = vertex as usize;
        if self.searches[i] != self.search {
            self.exact[i] = motion.positions(layout, vertex);
            let mapped = self.exact[i].map(|x| self.frame.map(x));
            debug_assert!(!M::HAS_ERROR_BOUND || mapped.iter().all(|x| F32Frame::can_contain(*x)));
            self.mapped[i] = mapped;
            self.searches[i] = self.search;
        }
    }

    /// Whether a vertex has been moved in this search.
    #[inline]
    pub(crate) fn is_moved(&self, vertex: u32) -> bool {
        self.searches[vertex as usize] == self.search
    }

    /// Returns the position of a moved vertex, at the start of the motion.
    #[inline]
    pub(crate) fn position(&self, vertex: u32) -> DVec3 {
        self.exact[vertex as usize][0]
    }

    /// Returns the positions of three moved vertices, at each configuration.
    #[inline]
    pub(crate) fn corners(&self, vertices: [u32; 3]) -> [[DVec3; 3]; E] {
        let corners = vertices.map(|v| &self.exact[v as usize]);
        std::array::from_fn(|end| corners.map(|x| x[end]))
    }

    /// Returns the positions in the frame by vertex, of which those of moved vertices are current.
    #[inline]
    pub(crate) fn mapped(&self) -> &[[Vec4; E]] {
        &self.mapped
    }

    /// Returns an AABB of moved vertices at all configurations, in the frame.
    pub(crate) fn mapped_aabb(&self, vertices: &[u32]) -> AabbF32 {
        let ends = vertices.iter().flat_map(|v| self.mapped[*v as usize]);
        ends.fold(AabbF32::EMPTY, |all, x| AabbF32 { lower: all.lower.min(x), upper: all.upper.max(x) })
    }

    /// Returns the frame of this search.
    #[inline]
    pub(crate) fn frame(&self) -> &F32Frame {
        &self.frame
    }
}
