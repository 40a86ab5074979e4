//! A monotone map from f64 to f32 coordinates: AABBs with disjoint images are disjoint.

use glam::{DVec3, Vec4};

use crate::geometry::Aabb;

/// A map from each coordinate to single precision.
///
/// AABBs of exact positions need no error bound, because the map preserves the order of two coordinates along an axis: it
/// subtracts a number, multiplies by a positive one, converts and clamps, each of them rounded to nearest, and every one of
/// these steps is monotone. So if one mapped box ends strictly before another one begins, the exact boxes do, too: disjoint
/// images are a proof for any centre and scale. With a bad choice disjoint boxes may seem to overlap, far from the centre (a
/// shape of size 1 at 1e8) or below the smallest normal numbers.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct F32Frame {
    center: DVec3,
    scale: f64,
}

impl F32Frame {
    /// Returns the frame in which this box (its corners in any order) is about [-1, 1] along its longest side.
    pub(crate) fn around(Aabb { lower, upper }: Aabb) -> Self {
        let half = (upper * 0.5 - lower * 0.5).abs().max_element();
        // The scale is finite, so that its product with 0 is not NaN.
        Self { center: lower * 0.5 + upper * 0.5, scale: (1.0 / half).min(f64::MAX) }
    }

    /// Returns the positive number by which coordinates are multiplied.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns an upper bound, along each axis, of the distance from a mapped point to its exact image, if the box of the
    /// frame contains all points. `rounding` bounds the error of the points themselves. The bound is at least the sum of
    /// 14 units of 2^-24, which the separating-axis test assumes, and four times the rounding, which sweeps assume.
    pub(crate) fn error_bound(&self, rounding: f64) -> f32 {
        let unit = f64::from(f32::EPSILON) / 2.0;
        let error = 16.0 * unit + 4.1 * rounding * self.scale;
        with_mutant!(error, FrameErrorQuartered, error / 4.0) as f32
    }

    /// Returns the point that is mapped to the origin.
    pub(crate) fn center(&self) -> DVec3 {
        self.center
    }

    /// Returns the mapped point before it is rounded to single precision.
    pub(crate) fn linear(&self, x: DVec3) -> DVec3 {
        (x - self.center) * self.scale
    }

    /// Whether a mapped point can be the image of a point of the frame's box, as [`Self::error_bound`] assumes. Images are in
    /// [-1, 1] up to rounding, or in [-2, 2] if the box is only a few units in the last place wide.
    pub(crate) fn can_contain(mapped: Vec4) -> bool {
        (mapped.abs().cmple(Vec4::splat(2.001)).bitmask() & 0b111) == 0b111
    }

    /// Returns the mapped point; its fourth component is unused. All components are finite.
    #[inline]
    pub(crate) fn map(&self, x: DVec3) -> Vec4 {
        let y = self.linear(x).as_vec3();
        y.extend(0.0).clamp(Vec4::MIN, Vec4::MAX)
    }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::Signed;

    use super::*;
    use crate::limits;

    /// The map keeps the order along each axis, for all magnitudes and in badly fitting frames.
    #[test]
    fn order_is_kept() {
        let mut numbers: Vec<f64> = (-1074..=200)
            .flat_map(|e| {
                // 2^-1074 is subnormal, so it is computed as a product.
                let x = 2.0_f64.powi(e / 2) * 2.0_f64.powi(e - e / 2);
                [x, x.next_up(), x.next_down(), x * 1.5].map(|x| x.min(limits::LARGEST))
            })
            .flat_map(|x| [x, -x])
            .chain([0.0, -0.0])
            .collect();
        numbers.sort_by(f64::total_cmp);
        let sizes = [0.0, f64::from_bits(1), 1e-310, 1e-60, 1e-7, 1.0, 1e8, limits::LARGEST];
        for (i, center) in sizes.into_iter().enumerate() {
            for half in sizes.into_iter().flat_map(|half| [half, -half]) {
                let center = if i % 2 == 0 { center } else { -center };
                let frame = F32Frame::around(Aabb {
                    lower: DVec3::splat(center - half),
                    upper: DVec3::splat(center + half),
                });
                let mapped: Vec<Vec4> = numbers.iter().map(|x| frame.map(DVec3::splat(*x))).collect();
                assert!(mapped.iter().all(|y| y.is_finite()), "{center} {half}");
                assert!(mapped.windows(2).all(|y| y[0].cmple(y[1]).all()), "{center} {half}");
            }
        }
    }

    /// The separating-axis test assumes an error bound of at least 14 units of 2^-24. It grants four error bounds; two of
    /// them cover the positions of both triangles, and its own sums need 20 of the 28 units of the other two. Sweeps
    /// assume that the same two contain eight rounding bounds. Mapped points are within the bound of their exact images.
    #[test]
    fn the_error_bound_is_at_least_what_its_users_assume() {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        let unit = 2.0_f64.powi(-24);
        for (i, half) in [1e-30, 1e-3, 1.0, 7.0, 1e9].into_iter().enumerate() {
            let center = half * [0.0, 3.0, -1e3][i % 3];
            let corner = |by: f64| DVec3::splat(center + by);
            let frame = F32Frame::around(Aabb { lower: corner(-half), upper: corner(half) });
            for rounding in [0.0, 1e-12 * half, 1e-7 * half, 1e-3 * half] {
                let error = f64::from(frame.error_bound(rounding));
                assert!(error >= 14.0 * unit + 4.0 * rounding / half, "{half} {rounding}: {error}");
                for j in 0..100 {
                    let x = center + half * (f64::from(j) / 50.0 - 1.0);
                    let mapped = exact(f64::from(frame.map(DVec3::splat(x)).x));
                    // The point itself has the error `rounding`.
                    for by in [rounding, -rounding] {
                        let image = (exact(x) + exact(by) - exact(frame.center.x)) * exact(frame.scale);
                        assert!((&mapped - image).abs() <= exact(error), "{half} {rounding} {j}");
                    }
                }
            }
        }
    }

    /// The frame uses the full range of single precision.
    #[test]
    fn positions_in_its_box_keep_their_precision() {
        for (center, half) in [(0.0, 1.0), (1e-200, 1e-210), (-1e50, 1e45), (0.0, 1e-300)] {
            let frame = F32Frame::around(Aabb {
                lower: DVec3::splat(center - half),
                upper: DVec3::splat(center + half),
            });
            let at = |t: f64| frame.map(DVec3::splat(center + half * t)).x;
            assert!((at(1.0) - 1.0).abs() < 1e-3 && (at(-1.0) + 1.0).abs() < 1e-3, "{center} {half}");
            assert!(at(0.5) < at(0.5 + 1e-5), "{center} {half}");
        }
    }
}
