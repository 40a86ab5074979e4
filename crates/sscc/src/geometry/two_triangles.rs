//! The corners of two triangles.

use glam::DVec3;

/// The corners of triangles a and b.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwoTriangles {
    pub(crate) a: [DVec3; 3],
    pub(crate) b: [DVec3; 3],
}

impl TwoTriangles {
    /// Returns the nine differences `b_j - a_i` of corners, at index `3 i + j`. Their hull contains all differences of points of
    /// the triangles.
    #[inline]
    pub(crate) fn differences(&self) -> [DVec3; 9] {
        std::array::from_fn(|ij| self.b[ij % 3] - self.a[ij / 3])
    }
}
