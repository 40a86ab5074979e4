//! Triangles whose corners move linearly.

use glam::DVec3;

use crate::geometry::Aabb;

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
    /// Creates a moving vertex.
    pub(crate) fn vertex(v_t0: DVec3, v_t1: DVec3) -> Self {
        Self { t0: [v_t0; 3], t1: [v_t1; 3] }
    }

    /// Creates a moving edge, given by its two ends.
    pub(crate) fn edge(e_t0: [DVec3; 2], e_t1: [DVec3; 2]) -> Self {
        let corners = |[p, q]: [DVec3; 2]| [p, q, q];
        Self { t0: corners(e_t0), t1: corners(e_t1) }
    }

    /// Returns the moving simplex of some of the corners.
    pub(crate) fn simplex(&self, corners: [usize; 3]) -> Self {
        Self { t0: corners.map(|i| self.t0[i]), t1: corners.map(|i| self.t1[i]) }
    }

    /// Multiplies all coordinates by a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { t0: self.t0.map(|p| p * factor), t1: self.t1.map(|p| p * factor) }
    }

    /// Returns the corners at time t, rounded (exact at t = 0 and t = 1).
    pub(super) fn at(&self, t: f64) -> [DVec3; 3] {
        std::array::from_fn(|i| self.t0[i] * (1.0 - t) + self.t1[i] * t)
    }

    /// Whether the swept AABBs of both overlap, exactly. Triangles whose swept AABBs are disjoint never meet.
    #[inline]
    pub(crate) fn is_swept_aabb_overlapping(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|triangle| Aabb::of_swept_triangle(&[triangle.t0, triangle.t1]));
        !a.is_disjoint(&b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Positions between integers are exact at quarters.
    #[test]
    fn corners_move_linearly() {
        let random = &mut Random(9);
        for _ in 0..20 {
            let mut corners = || [(); 3].map(|()| (random.vector() * 8.0).round());
            let triangle = MovingTriangle { t0: corners(), t1: corners() };
            for t in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let exact = |i: usize| triangle.t0[i] + (triangle.t1[i] - triangle.t0[i]) * t;
                assert_eq!(triangle.at(t), [0, 1, 2].map(exact), "{t}");
            }
        }
    }
}
