//! Corners on straight lines.

use glam::DVec3;

/// A triangle whose corners move linearly, from `t0` at time 0 to `t1` at time 1. Degenerate ones are segments and
/// points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingTriangle {
    /// The corners at time 0.
    pub t0: [DVec3; 3],
    /// The same corners at time 1.
    pub t1: [DVec3; 3],
}

impl MovingTriangle {
    /// A vertex on its way from one position to another.
    pub fn vertex(v_t0: DVec3, v_t1: DVec3) -> Self {
        Self { t0: [v_t0; 3], t1: [v_t1; 3] }
    }

    /// An edge, by its two ends.
    pub fn edge(e_t0: [DVec3; 2], e_t1: [DVec3; 2]) -> Self {
        let corners = |[a, b]: [DVec3; 2]| [a, b, b];
        Self { t0: corners(e_t0), t1: corners(e_t1) }
    }

    /// The hull of some of the corners.
    pub(crate) fn hull(&self, corners: [usize; 3]) -> Self {
        Self { t0: corners.map(|i| self.t0[i]), t1: corners.map(|i| self.t1[i]) }
    }

    /// All coordinates times a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { t0: self.t0.map(|p| p * factor), t1: self.t1.map(|p| p * factor) }
    }

    /// The corners at time t, rounded (t = 0 and t = 1 are exact).
    pub(super) fn at(&self, t: f64) -> [DVec3; 3] {
        std::array::from_fn(|i| self.t0[i] * (1.0 - t) + self.t1[i] * t)
    }

    /// Whether the boxes around the two ways overlap, exactly. Triangles whose boxes do not never meet.
    #[inline]
    pub(crate) fn swept_box_meets(&self, other: &Self) -> bool {
        let [(a, b), (c, d)] = [self, other].map(|m| {
            let corners = || m.t0.iter().chain(&m.t1);
            (
                corners().fold(DVec3::INFINITY, |l, p| l.min(*p)),
                corners().fold(DVec3::NEG_INFINITY, |u, p| u.max(*p)),
            )
        });
        a.cmple(d).all() && c.cmple(b).all()
    }
}
