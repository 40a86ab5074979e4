//! The map of coarse positions of shapes in the world, from a frame in axes of the model to the frame of a search.

use glam::{DMat3, DVec3, Vec4};

use super::aabb8::AabbF32;
use super::f32_frame::F32Frame;
use crate::vectors::Vectors;

/// An affine map in single precision.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameMap {
    /// The columns of the matrix; their fourth components are 0.
    columns: [Vec4; 3],
    shift: Vec4,
    /// An upper bound, along each axis, of the distance from the image of a coarse position to the exact one mapped to the frame
    /// of the search.
    error: f32,
}

/// With a larger error bound, as a share of the shape's size, exact positions are used: too many boxes would overlap.
const MAX_ERROR: f64 = 1.0 / 512.0;

impl FrameMap {
    /// Returns the map of a shape with this rotation (any matrix) and translation, from `own`, whose box contains its positions in
    /// axes of the model, to `world`, whose box contains them in the world. `error` is the error bound of coarse positions in `own`,
    /// and `rounding` that of exact positions in the world. `None` if the error would be too large.
    ///
    /// Error bound. Let u = 2^-24 and r the largest sum of magnitudes of a row of the matrix. Images in either frame are in
    /// [-2.001, 2.001], so the shift is at most 2.001 (1 + r). The error of entries, shift, three products and three sums is at most
    /// 8 u times the sum of all magnitudes, 2.1 r + 2.001 (1 + r). Half extents of AABBs are at most about d, the sum of all
    /// factors in [`Quantization::begin`](super::quantization::Quantization::begin). Centres and half extents, their products and
    /// ends add at most 20 u r (1 + d). That is at most 6 u r and r times `error`, which AABBs contain already. Exact positions
    /// are mapped with the error of the frame.
    pub(crate) fn new(
        [own, world]: [&F32Frame; 2],
        (rotation, translation): (DMat3, DVec3),
        error: f32,
        rounding: f64,
    ) -> Option<Self> {
        let ratio = world.scale() / own.scale();
        let matrix = rotation * ratio;
        let row = matrix.x_axis.abs() + matrix.y_axis.abs() + matrix.z_axis.abs();
        let row = row.max_element();
        let shift = world.linear(rotation * own.center() + translation);
        let unit = f64::from(f32::EPSILON) / 2.0;
        let rounded = 64.0 * unit * (1.0 + row);
        let turned = with_mutant!(row * f64::from(error), FrameMapOfExactPositions, 0.0);
        let all = 1.01 * (turned + rounded) + f64::from(world.error_bound(rounding));
        // NaN fails this comparison.
        (all <= MAX_ERROR * row).then(|| Self {
            columns: [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.as_vec3().extend(0.0)),
            shift: shift.as_vec3().extend(0.0),
            error: (all * (1.0 + 1e-6)) as f32,
        })
    }

    /// Returns the error bound of the map, see the field `error`.
    pub(crate) fn error(&self) -> f32 {
        self.error
    }

    /// Returns the images of eight positions, by their coordinates along each axis.
    #[inline(always)]
    pub(super) fn apply<V: Vectors>(&self, v: V, x: [V::F32s; 3]) -> [V::F32s; 3] {
        let mut images = x;
        for axis in 0..3 {
            let mut sum = v.splat(self.shift[axis]);
            for column in 0..3 {
                sum = v.multiply_add(v.splat(self.columns[column][axis]), x[column], sum);
            }
            images[axis] = sum;
        }
        images
    }

    /// Returns an AABB of the images of all points of an AABB. If the AABB contains coarse positions, the result contains the exact ones.
    #[inline]
    pub(super) fn apply_to_aabb(&self, AabbF32 { lower, upper }: AabbF32) -> AabbF32 {
        let (center, half) = ((lower + upper) * 0.5, (upper - lower) * 0.5);
        let [x, y, z] = self.columns;
        let center = x * center.x + y * center.y + z * center.z + self.shift;
        let half = x.abs() * half.x + y.abs() * half.y + z.abs() * half.z;
        let half = half + Vec4::splat(self.error);
        AabbF32 { lower: center - half, upper: center + half }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    #[test]
    fn errors_and_boxes_are_those_of_their_formulas() {
        let around = |x: f64| F32Frame::around(Aabb { lower: DVec3::splat(-x), upper: DVec3::splat(x) });
        let (own, world) = (around(1.0), around(2.0));
        let columns = [[0.3, -0.5, 0.2], [0.7, 0.4, -0.1], [-0.6, 0.2, 0.9]].map(DVec3::from_array);
        let rotation = DMat3::from_cols(columns[0], columns[1], columns[2]);
        let (error, rounding) = (1e-4_f32, 1e-6);
        let pose = (rotation, DVec3::new(0.1, 0.2, 0.3));
        let map = FrameMap::new([&own, &world], pose, error, rounding).unwrap();
        // The first row has the largest sum, 1.6; the frame of the world has half the scale.
        let rounded = 64.0 * 2.0_f64.powi(-24) * 1.8;
        let all = 1.01 * (0.8 * f64::from(error) + rounded) + f64::from(world.error_bound(rounding));
        let found = f64::from(map.error());
        assert!(found >= all && found <= all * (1.0 + 3e-6), "{found} {all}");
        let lower = Vec4::new(-0.5, -0.25, 0.0, 0.0);
        let image = map.apply_to_aabb(AabbF32 { lower, upper: Vec4::new(0.5, 0.75, 0.5, 0.0) });
        let center = Vec4::new(0.0625, 0.175, 0.25, 0.0);
        let half = Vec4::new(0.325, 0.25, 0.1875, 0.0) + Vec4::splat(map.error());
        for (found, expected) in [(image.lower, center - half), (image.upper, center + half)] {
            assert!((found - expected).truncate().abs().max_element() < 1e-6, "{found} {expected}");
        }
    }
}
