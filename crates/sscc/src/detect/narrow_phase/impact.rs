//! `Impact`: two triangles that collide during a motion, and when.

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
    /// How close two triangles must come to be listed though they do not touch: this share (2^-40, about 1e-12) of
    /// their size, see [`impact_triangle_triangle`](crate::impact_triangle_triangle). Well above the rounding error.
    pub const TOLERANCE: f64 = 1.0 / (1_u64 << 40) as f64;
}
