//! `Pose`: rotation and translation of a shape in the world.

use glam::{DMat3, DVec3};

use crate::geometry::Aabb;
use crate::{Error, limits};

/// The pose of a shape in the world: `x -> rotation x + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The matrix: a rotation for a rigid motion, but any matrix is valid.
    pub rotation: DMat3,
    /// The translation, which is added after the rotation (model unit).
    pub translation: DVec3,
}

impl Default for Pose {
    fn default() -> Self {
        Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO }
    }
}

impl Pose {
    /// Returns the position in the world of a point of the shape, by f64 products and sums in a fixed order, none fused.
    #[inline]
    pub fn apply(&self, x: DVec3) -> DVec3 {
        self.rotation * x + self.translation
    }

    /// Returns an AABB of the world positions of all points of an AABB; `rounding` bounds the rounding error.
    #[inline]
    pub(super) fn apply_to_aabb(&self, Aabb { lower, upper }: Aabb, rounding: f64) -> Aabb {
        let [x, y, z] = [self.rotation.x_axis, self.rotation.y_axis, self.rotation.z_axis].map(DVec3::abs);
        let half = (upper - lower) * 0.5;
        let widened = DVec3::splat(with_mutant!(rounding, PosedAabbExact, 0.0));
        let half = x * half.x + y * half.y + z * half.z + widened;
        let center = self.apply(lower * 0.5 + upper * 0.5);
        Aabb { lower: center - half, upper: center + half }
    }

    /// Returns an upper bound (up to rounding) of every sum of magnitudes in a position in the world, if coordinates of the
    /// shape are at most `own`, which [`ReducedModel::check_coordinates`](crate::ReducedModel::check_coordinates) returns.
    ///
    /// # Errors
    /// When the pose is not finite, or 1.001 times the bound is beyond [`limits::LARGEST`].
    pub fn check_reach(&self, own: f64) -> Result<f64, Error> {
        let r = &self.rotation;
        let row = r.x_axis.abs() + r.y_axis.abs() + r.z_axis.abs();
        let reach = row.max_element() * own + self.translation.abs().max_element();
        // Rounding may move a position a little beyond the exact reach. A maximum ignores NaN, which is therefore checked first.
        let is_finite = self.rotation.is_finite() && self.translation.is_finite();
        if is_finite && reach * 1.001 <= limits::LARGEST {
            return Ok(reach);
        }
        let (name, wanted) =
            ("the largest coordinate of the posed shape", "finite and at most 2^200 (about 1.6e60)");
        Err(Error::Option { name, value: if is_finite { reach } else { f64::NAN }, wanted })
    }
}

/// Returns the box if it is finite, else the empty one. A box around all compared shapes affects only the speed, and no frame can
/// be made of one that is infinite.
pub(super) fn finite_or_empty(around: Aabb) -> Aabb {
    let is_finite = around.lower.is_finite() && around.upper.is_finite();
    if with_mutant!(is_finite, PosedFramesOfAnyBox, true) { around } else { Aabb::EMPTY }
}
