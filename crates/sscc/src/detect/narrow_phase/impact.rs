//! `Impact`: two triangles that collide during a motion, and the time of impact.

use crate::Pair;

/// Two triangles that collide during a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    /// The triangles: the lower number first; of two meshes, the triangle of the first mesh first.
    pub pair: Pair,
    /// The time of impact, from 0 to 1: never later than the true one, see
    /// [`Query::continuous`](crate::Query::continuous).
    pub time: f64,
}

impl Impact {
    /// Triangles that do not touch may be listed if they come closer than this share (2^-40, about 1e-12) of their
    /// size, see [`impact_triangle_triangle`](crate::impact_triangle_triangle). It is well above the rounding error.
    pub const TOLERANCE: f64 = 1.0 / (1_u64 << 40) as f64;
}
