//! Displacements quantized to 16 bits: a quarter of the bytes of double precision.
//!
//! Vertices are moved in single precision, eight side by side, with a bound of the error.

use glam::{DVec3, Vec4};

use super::f32_frame::F32Frame;
use super::frame_map::FrameMap;
use super::vertex_store::VertexStore;
use crate::ReducedModel;
use crate::geometry::Aabb;
use crate::vectors::LANES;

/// The scales of quantized displacements, which are shares of the largest displacement by the same mode. The rest pose is
/// an additional first mode, whose coordinate is 1.
#[derive(Default)]
pub(crate) struct Quantization {
    /// The centre of the box of the rest pose.
    center: DVec3,
    /// The largest distance of a rest position from the centre along an axis.
    half: f64,
    /// The largest displacement by each mode.
    sizes: Vec<f64>,
}

/// The integer that stands for the largest displacement.
const WHOLE: f64 = 32767.0;

/// With a larger error bound, in the coordinates of the frame, exact positions are used: too many boxes would overlap.
const MAX_ERROR: f64 = 1.0 / 2048.0;

/// The factors of quantized displacements in one query.
#[derive(Clone)]
pub(crate) struct CoarseMotion<const E: usize> {
    /// The centre of the rest pose in the frame.
    pub(crate) shift: [Vec4; E],
    /// For each mode its factor.
    pub(crate) factors: Vec<[f32; E]>,
    /// For each mode the factors of the six components of a BD-tree AABB: the factor of the mode for its centre, and the larger
    /// magnitude of the factors at both configurations for its half extents. Two lanes are 0.
    pub(crate) node_factors: Vec<[[f32; LANES]; E]>,
    /// An upper bound, along each axis, of the distance from coarse positions to the exact ones mapped to the frame.
    pub(crate) error: f32,
    /// For shapes in the world the maps to the frame of the search. The fields above then refer to a frame in axes of the model.
    pub(crate) maps: Option<[FrameMap; E]>,
}

impl<const E: usize> Default for CoarseMotion<E> {
    fn default() -> Self {
        Self {
            shift: [Vec4::ZERO; E],
            factors: Vec::new(),
            node_factors: Vec::new(),
            error: f32::INFINITY,
            maps: None,
        }
    }
}

impl<const E: usize> CoarseMotion<E> {
    /// Returns the error bound of coarse positions in the frame of the search.
    pub(crate) fn search_error(&self) -> f32 {
        let maps = self.maps.as_ref();
        maps.map_or(self.error, |maps| maps.iter().fold(0.0, |most, map| map.error().max(most)))
    }
}

impl Quantization {
    pub(crate) fn new(model: &ReducedModel, vertices: &VertexStore) -> Self {
        let at_rest = (0..vertices.count() as u32).map(|index| vertices.rest(index));
        let Aabb { lower, upper } =
            if vertices.count() == 0 { Aabb::default() } else { Aabb::of_points(at_rest) };
        let center = lower * 0.5 + upper * 0.5;
        let half = (upper - center).max(center - lower).max_element();
        Self {
            center,
            half,
            sizes: (0..model.rank()).map(|k| model.mode_displacement_bound(k, 1.0)).collect(),
        }
    }

    /// Quantizes a rest position and its displacements by each mode.
    pub(crate) fn quantize<'t>(
        &'t self,
        rest: DVec3,
        modes: impl Iterator<Item = DVec3> + 't,
    ) -> impl Iterator<Item = [i16; 3]> + 't {
        self.quantize_extents(rest - self.center, modes)
    }

    /// Quantizes half extents at rest and their growth by each mode.
    pub(crate) fn quantize_extents<'t>(
        &'t self,
        rest: DVec3,
        modes: impl Iterator<Item = DVec3> + 't,
    ) -> impl Iterator<Item = [i16; 3]> + 't {
        let quantized = |(u, size): (DVec3, f64)| {
            let u = if size > 0.0 { u / size * WHOLE } else { DVec3::ZERO };
            u.to_array().map(|x| x.round() as i16)
        };
        std::iter::once((rest, self.half)).chain(modes.zip(self.sizes.iter().copied())).map(quantized)
    }

    /// Sets the factors of a query in a frame whose box contains all positions; `rounding` bounds the error of exact
    /// positions. False if the error bound would exceed [`MAX_ERROR`]: then the query must use exact positions.
    ///
    /// Error bound. Let u = 2^-24 and d the sum of all factors.
    /// - Partial sums are at most 1 + 2 d: the centre of the rest pose is within 1 + d of that of the frame, because
    ///   each vertex is within 1 of the latter.
    /// - Each of the r + 1 sums adds u (1 + 2 d).
    /// - Factors and products add 2 u d.
    /// - Shift, mapped position and widening add u (3 + d).
    /// - Quantization adds d / (2 WHOLE): half a unit of each mode.
    ///
    /// A sum of the larger magnitudes at the start and the end of a motion is at most 2 d, and each of its terms is at
    /// least as large as at either end.
    pub(crate) fn begin<const E: usize>(
        &self,
        motion: &mut CoarseMotion<E>,
        q: [&[f64]; E],
        frame: &F32Frame,
        rounding: f64,
    ) -> bool {
        let unit = f64::from(f32::EPSILON) / 2.0;
        let scale = frame.scale();
        let rest = self.half * scale;
        let factor = |x: f64| (x / WHOLE) as f32;
        motion.factors.clear();
        motion.factors.push([factor(rest); E]);
        let mut sums = [rest; E];
        for (k, size) in self.sizes.iter().enumerate() {
            let factors = q.map(|q| q[k] * size * scale);
            (0..E).for_each(|end| sums[end] += factors[end].abs());
            motion.factors.push(factors.map(factor));
        }
        let of_node = |ends: &[f32; E]| {
            let largest = ends.iter().fold(0.0_f32, |most, factor| most.max(factor.abs()));
            ends.map(|factor| [factor, factor, factor, largest, largest, largest, 0.0, 0.0])
        };
        motion.node_factors.clear();
        motion.node_factors.extend(motion.factors.iter().map(of_node));
        let most = if sums.iter().all(|sum| sum.is_finite()) {
            sums.into_iter().fold(0.0, f64::max)
        } else {
            f64::INFINITY
        };
        let quantized = with_mutant!(most / (2.0 * WHOLE), QuantizationExact, 0.0);
        let rounded = unit * (self.sizes.len() + 12) as f64 * (1.0 + 2.0 * most) + quantized;
        let error = 1.1 * rounded + 4.0 * rounding * scale;
        motion.shift = [frame.linear(self.center).as_vec3().extend(0.0); E];
        motion.error = (error * (1.0 + 1e-6)) as f32;
        error <= MAX_ERROR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_bound_is_that_of_its_formula() {
        let mut used = [0; 2];
        for (rank, size) in [(1, 1e-3), (7, 1.0), (60, 1e3)] {
            let sizes = (0..rank).map(|k| size * f64::from(k + 1)).collect();
            let quantization = Quantization { center: DVec3::ZERO, half: 0.75 * size, sizes };
            let frame = F32Frame::around(Aabb { lower: DVec3::splat(-size), upper: DVec3::splat(size) });
            // Factors of modes add up to 3 and to 1.5.
            let q = |sum: f64| -> Vec<f64> { (0..rank).map(|k| -sum / f64::from(rank * (k + 1))).collect() };
            let ends = [q(1.5), q(3.0)];
            for share in [0.0, 1e-6, 1e-3] {
                let mut motion = CoarseMotion::<2>::default();
                let ends = ends.each_ref().map(|q| &q[..]);
                let is_used = quantization.begin(&mut motion, ends, &frame, share * size);
                let rounded = 2.0_f64.powi(-24) * f64::from(rank + 12) * (1.0 + 2.0 * 3.75);
                let bound = 1.1 * (rounded + 3.75 / (2.0 * WHOLE)) + 4.0 * share;
                let error = f64::from(motion.error);
                assert!(error >= bound && error <= bound * (1.0 + 3e-6), "{rank} {share}: {error} {bound}");
                assert_eq!(is_used, bound <= MAX_ERROR);
                used[usize::from(is_used)] += 1;
            }
        }
        assert_eq!(used, [3, 6]);
    }
}
