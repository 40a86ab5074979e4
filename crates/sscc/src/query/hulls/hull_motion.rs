//! The factors of all hulls in one search, and the bound of their error.

use glam::{DVec3, Vec4};

use super::node_hulls::NodeHulls;
use crate::detect::f32_frame::F32Frame;
use crate::detect::vertex_motion::rounding_bound;

/// With a larger error bound, in the coordinates of the frame, too few node pairs would be separated.
const MAX_ERROR: f64 = 1.0 / 64.0;

/// Length of the diagonal of the unit cube, rounded up: errors here are along each axis, radii are lengths in any direction.
const DIAGONAL: f64 = 1.7321;

/// The factors of one search, in the coordinates of its frame.
#[derive(Clone)]
pub(super) struct HullMotion<const E: usize> {
    /// The factor of the rest, then of each mode, at each configuration: its magnitude, and three copies
    /// of itself.
    pub(super) factors: Vec<[Vec4; E]>,
    /// The centre of the shape.
    pub(super) shift: [f32; 3],
    /// An upper bound of the distance of a core point from where exact arithmetic would place it, and of a vertex from
    /// the position of the shape. It also covers the evaluation of distances from a plane.
    pub(super) error: f32,
    /// The relative error of sums over the modes, in units of `sum_k t_k` (see `residuals`): factors and products add 2 u, sums
    /// (r + 1) u, vectors that are longer than 1 by rounding 2 u, and the root of the sum of squares less than all of these.
    /// Products with `g_j` and `rho` and their sums add 6 u. Twice (r + 16) u covers them all.
    pub(super) relative: f32,
    /// Coordinates in the frame for each unit of length, rounded up.
    pub(super) scale: f64,
}

impl<const E: usize> Default for HullMotion<E> {
    fn default() -> Self {
        Self { factors: Vec::new(), shift: [0.0; 3], error: f32::INFINITY, relative: 0.0, scale: 0.0 }
    }
}

impl<const E: usize> HullMotion<E> {
    /// Sets the factors at each q. `rounding` bounds the error of the shape's positions. False if the error bound is
    /// so large that hulls would prove nothing.
    ///
    /// Error bound. Let u = 2^-24, and T the sum of the magnitudes of all terms of a coordinate of any core point: the
    /// factors times [`NodeHulls::weights`], and the shift.
    /// - Factors and their products add 2 u T, their sums (r + 1) u T, the shift u T.
    /// - The coordinate of a core point along a unit normal is `D . (F' n) + c . n`: two products of 3 terms each one
    ///   after the other, and a sum. That adds 7 u T along each axis. The error of F times `eps`, which is at most 2,
    ///   adds as much.
    /// - The computed positions at q, and those at the configuration of the hulls, are within their rounding bounds,
    ///   which are 8 times larger: they cover `q - configuration` and the units of the hulls, too. (The bound at q
    ///   alone would do: a position at the configuration is rounded by at most `(r + 1) 2^-53` times its terms. These
    ///   exceed the terms at q by `|U_k y_k|` at most, which are terms of core points and residuals, and are rounded
    ///   here by far more.)
    ///
    /// The last number of the error covers underflow: squares of residuals and of entries of F below 1e-19, and products.
    /// The error is at least 32 u times the terms of a coordinate, and at most 1 / 64, so coordinates are below 1e4.
    pub(super) fn begin(
        &mut self,
        hulls: &NodeHulls,
        q: [&[f64]; E],
        frame: &F32Frame,
        rounding: f64,
    ) -> bool {
        let unit = f64::from(f32::EPSILON) / 2.0;
        self.scale = frame.scale() * (1.0 + 1e-12);
        let factor = |x: f64| {
            let x = x as f32;
            Vec4::new(x.abs(), x, x, x)
        };
        let shift = frame.linear(hulls.center);
        self.shift = shift.as_vec3().to_array();
        let rest = hulls.half * frame.scale();
        self.factors.clear();
        self.factors.push([factor(rest); E]);
        let mut sums = [shift.abs().max_element() + rest * hulls.weights[0]; E];
        for (k, size) in hulls.sizes.iter().enumerate() {
            let y = |q: &[f64]| q[k] - with_mutant!(hulls.configuration[k], HullWithoutConfiguration, 0.0);
            let factors = q.map(|q| y(q) * size * frame.scale());
            (0..E).for_each(|end| sums[end] += factors[end].abs() * hulls.weights[k + 1]);
            self.factors.push(factors.map(factor));
        }
        // NaN must fail the comparison below, too.
        let most = if sums.iter().all(|sum| sum.is_finite()) {
            sums.into_iter().fold(0.0, f64::max)
        } else {
            f64::INFINITY
        };
        let rank = hulls.rank as f64;
        let single = with_mutant!((3.0 * rank + 32.0) * unit * most, HullSinglePrecisionExact, 0.0);
        let at_configuration = rounding_bound(hulls.reach, hulls.rank);
        let double = (rounding + with_mutant!(at_configuration, HullConfigurationExact, 0.0)) * self.scale;
        let error = 1.01 * DIAGONAL * (single + with_mutant!(double, HullShapeExact, 0.0)) + 1e-15;
        self.error = error as f32;
        self.relative = with_mutant!((2.0 * (rank + 16.0) * unit) as f32, HullSumsExact, 0.0);
        error <= MAX_ERROR
    }

    /// Converts displacements along the axes to a distance in the frame, rounded up.
    pub(super) fn distance(&self, displacement: DVec3) -> f32 {
        // Scaled first: in the units of a tiny model squares would underflow.
        let scaled = (displacement * self.scale).length();
        let length = with_mutant!(scaled, HullSlackUnscaled, displacement.length() * self.scale);
        ((length * (1.0 + 1e-6)) as f32).min(f32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificates::Scope;
    use crate::geometry::Aabb;
    use crate::hierarchy::Hierarchy;
    use crate::test_models::Random;
    use crate::{Modes, ReducedModel, TriMesh};

    /// Tests the units of tiny and huge models, whose squares are not normal floating-point numbers.
    #[test]
    fn displacements_are_never_short_in_the_frame() {
        for size in [1e-300, 1e-165, 1e-160, 1e-157, 1.0, 1e157, 1e165] {
            let motion = HullMotion::<1> { scale: 1.0 / size, ..HullMotion::default() };
            let distance = f64::from(motion.distance(DVec3::new(3.0, 4.0, 12.0) * size));
            assert!((13.0..13.001).contains(&distance), "{size}: {distance}");
        }
    }

    /// The factors, the shift and the error bound are those of the formulas, whichever term is the largest.
    #[test]
    fn numbers_of_a_motion_are_those_of_the_formulas() {
        let random = &mut Random(41);
        let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(3, DVec3::AXES.repeat(3)).unwrap()).unwrap();
        let hierarchy = Hierarchy::build(&model, &Scope::of(&model).metric);
        let mut hulls = NodeHulls::new(&model, &hierarchy, &[(0, 0)], &[0.0; 3]).unwrap();
        let unit = f64::from(f32::EPSILON) / 2.0;
        let (mut useful, mut useless) = (0, 0);
        for case in 0..300 {
            hulls.configuration = (0..3).map(|_| random.signed()).collect();
            hulls.sizes = (0..3).map(|_| random.power(-2.0, 2.0)).collect();
            hulls.weights = (0..4).map(|_| random.power(-1.0, 1.0)).collect();
            (hulls.center, hulls.half) = (random.vector(), random.power(-2.0, 2.0));
            hulls.reach = random.power(-6.0, 14.0);
            let (rounding, center) = (random.power(-15.0, 0.0), random.vector());
            let half = DVec3::splat(random.power(-1.0, 1.0));
            let frame = F32Frame::around(Aabb { lower: center - half, upper: center + half });
            let q: [[f64; 3]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| 3.0 * random.signed()));
            let mut motion = HullMotion::<2>::default();
            let is_useful = motion.begin(&hulls, [&q[0], &q[1]], &frame, rounding);

            let scale = frame.scale();
            assert!(motion.scale > scale && motion.scale < scale * (1.0 + 1e-11), "case {case}");
            let shift = (hulls.center - frame.center()) * scale;
            for axis in 0..3 {
                assert!((f64::from(motion.shift[axis]) - shift[axis]).abs() <= 1e-7 * shift[axis].abs());
            }
            assert_eq!(motion.factors.len(), 4);
            let mut most = 0.0_f64;
            for (end, q) in q.iter().enumerate() {
                let mut terms = shift.abs().max_element();
                for (k, factors) in motion.factors.iter().enumerate() {
                    let exact = match k {
                        0 => hulls.half * scale,
                        _ => (q[k - 1] - hulls.configuration[k - 1]) * hulls.sizes[k - 1] * scale,
                    };
                    let factor = factors[end];
                    let difference = (f64::from(factor.y) - exact).abs();
                    assert!(difference <= 1e-7 * exact.abs(), "case {case}, {k}: {factor} {exact}");
                    assert_eq!((factor.x, factor.z, factor.w), (factor.y.abs(), factor.y, factor.y));
                    terms += exact.abs() * hulls.weights[k];
                }
                most = most.max(terms);
            }
            let single = (3.0 * 3.0 + 32.0) * unit * most;
            let double = (rounding + rounding_bound(hulls.reach, 3)) * scale;
            let error = f64::from(motion.error) / (3.0_f64.sqrt() * (single + double));
            assert!((1.0..1.02).contains(&error), "case {case}: {single} {double} {error}");
            assert_eq!(is_useful, motion.error <= 1.0 / 64.0, "case {case}");
            assert_eq!(f64::from(motion.relative), 2.0 * (3.0 + 16.0) * unit);
            (useful, useless) = (useful + i32::from(is_useful), useless + i32::from(!is_useful));
        }
        assert!(useful > 30 && useless > 30, "{useful} {useless}");

        // Of the error of a shape that is a point at the centre, only the part for underflow is left.
        (hulls.center, hulls.half, hulls.reach) = (DVec3::ZERO, 0.0, 0.0);
        hulls.sizes.fill(0.0);
        let frame = F32Frame::around(Aabb { lower: DVec3::NEG_ONE, upper: DVec3::ONE });
        let mut motion = HullMotion::<1>::default();
        assert!(motion.begin(&hulls, [&[0.0; 3]], &frame, 0.0));
        assert!((0.99e-15..1.01e-15).contains(&f64::from(motion.error)), "{}", motion.error);
    }
}
