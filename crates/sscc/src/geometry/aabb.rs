//! Axis-aligned bounding boxes (AABBs) in double precision.

use glam::DVec3;

/// An axis-aligned bounding box (model unit), closed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aabb {
    /// The smallest coordinate along each axis.
    pub lower: DVec3,
    /// The largest coordinate along each axis.
    pub upper: DVec3,
}

impl Aabb {
    /// The empty box; its union with another box is that box.
    pub const EMPTY: Self = Self { lower: DVec3::INFINITY, upper: DVec3::NEG_INFINITY };

    /// Returns the smallest box that contains the points; [`Aabb::EMPTY`] for no points.
    pub fn of_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points
            .into_iter()
            .fold(Self::EMPTY, |all, p| Self { lower: all.lower.min(p), upper: all.upper.max(p) })
    }

    /// Returns the AABB of a triangle.
    #[inline]
    pub(crate) fn of_triangle([a, b, c]: [DVec3; 3]) -> Self {
        Self { lower: a.min(b).min(c), upper: a.max(b).max(c) }
    }

    /// Returns the swept AABB of a triangle: the AABB of its corners at all `E` configurations of a motion.
    #[inline]
    pub(crate) fn of_swept_triangle<const E: usize>(corners: &[[DVec3; 3]; E]) -> Self {
        corners.map(Self::of_triangle).into_iter().reduce(|a, b| a.union(&b)).unwrap_or_default()
    }

    /// Returns the smallest box that contains both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    /// Whether the boxes have no point in common. Boxes with NaN are never disjoint.
    #[inline]
    pub fn is_disjoint(&self, other: &Self) -> bool {
        with_mutant!(
            (self.lower.cmpgt(other.upper) | other.lower.cmpgt(self.upper)).any(),
            TouchingBoxesDisjoint,
            (self.lower.cmpge(other.upper) | other.lower.cmpge(self.upper)).any()
        )
    }

    /// Whether the boxes are farther apart than a distance along some axis.
    pub(crate) fn is_farther(&self, other: &Self, distance: f64) -> bool {
        let gap = (self.lower - other.upper).max(other.lower - self.upper).max_element();
        with_mutant!(gap > distance, FartherByHalf, gap > 0.5 * distance)
    }

    /// Returns the middle of the box.
    #[inline]
    pub fn center(&self) -> DVec3 {
        self.lower * 0.5 + self.upper * 0.5
    }
}
