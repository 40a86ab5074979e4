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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Returns a pose with any matrix, small or large.
    fn pose(random: &mut Random) -> Pose {
        let columns = [(); 3].map(|()| random.vector());
        let rotation = DMat3::from_cols(columns[0], columns[1], columns[2]) * random.power(-3.0, 3.0);
        Pose { rotation, translation: random.vector() * random.power(-3.0, 3.0) }
    }

    /// The smallest AABB of a box in the world is that of its corners.
    #[test]
    fn aabbs_are_those_of_all_corners_and_the_rounding() {
        let random = &mut Random(2);
        for case in 0..300 {
            let pose = pose(random);
            let (a, b) = (random.vector() * random.power(-3.0, 3.0), random.vector());
            let [lower, upper] = [a.min(b), a.max(b)];
            let corner = |i: u32| {
                let of_axis = |axis: usize| if i >> axis & 1 == 0 { lower[axis] } else { upper[axis] };
                pose.apply(DVec3::new(of_axis(0), of_axis(1), of_axis(2)))
            };
            let exact = Aabb::of_points((0..8).map(corner));
            let rounding = random.power(-6.0, 0.0);
            let found = pose.apply_to_aabb(Aabb { lower, upper }, rounding);
            let reach = pose.check_reach(a.abs().max(b.abs()).max_element()).unwrap();
            let limit = 1e-13 * (reach + rounding);
            for (found, exact) in
                [(found.lower, exact.lower - rounding), (found.upper, exact.upper + rounding)]
            {
                assert!((found - exact).abs().max_element() <= limit, "case {case}: {found} {exact}");
            }
        }
    }

    #[test]
    fn reaches_are_the_largest_sums_of_magnitudes() {
        let random = &mut Random(3);
        for case in 0..300 {
            let (pose, own) = (pose(random), random.power(-3.0, 3.0));
            let row = |i: usize| (0..3).map(|k| pose.rotation.col(k)[i].abs()).sum::<f64>();
            let rows = (0..3).map(row).fold(0.0, f64::max);
            let shift = (0..3).map(|i| pose.translation[i].abs()).fold(0.0, f64::max);
            let (expected, found) = (rows * own + shift, pose.check_reach(own).unwrap());
            assert!((found - expected).abs() <= 1e-14 * expected, "case {case}: {found} {expected}");
        }
        // A thousandth of the range is left for rounding.
        for (divisor, is_valid) in [(1.0011, true), (1.0009, false), (1.0, false)] {
            let own = limits::LARGEST / divisor;
            assert_eq!(Pose::default().check_reach(own).is_ok(), is_valid, "{divisor}");
        }
    }

    #[test]
    fn only_infinite_boxes_are_replaced() {
        let finite = Aabb { lower: DVec3::new(-1.0, 5.0, 2.0), upper: DVec3::new(3.0, 7.0, -2.0) };
        assert_eq!(finite_or_empty(finite), finite);
        for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for axis in 0..3 {
                let (mut low, mut high) = (finite, finite);
                (low.lower[axis], high.upper[axis]) = (wrong, wrong);
                assert_eq!([low, high].map(finite_or_empty), [Aabb::EMPTY; 2]);
            }
        }
    }
}
