//! The certified bound of a triangle pair: cheap bounds first, subdivision only as far as necessary.
//!
//! This bound replaces the constant-mode bound of the paper's section 5.1 and keeps its scheme: a lower and an upper bound, and
//! midpoint subdivision until they are within the tolerance.

use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};

use super::affine_bound::{AffineBound, is_near};
use super::pair_corners::PairCorners;
use super::separating_direction::{CornerProjections, bound_along, bound_rest_distance};
use super::sub_triangle::{MAX_DEPTH, SubPair};
use super::upper_bound::{Ray, RelativeModes};
use crate::geometry::nearest_to_origin;
use crate::min_heap::MinHeapEntry;
use crate::model::{ScaledModel, scale_direction};

/// How far the bound of a triangle pair is refined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefinementTarget {
    /// Refinement stops at this radius.
    pub(crate) cap: f64,
    /// The smallest upper bound found so far.
    pub(crate) upper: f64,
    /// The allowed relative error.
    pub(crate) epsilon: f64,
    /// Maximum number of subdivisions of one triangle pair. The best lower bound after them is the result: certified, but smaller
    /// than it could be.
    pub(crate) subdivisions: usize,
}

impl RefinementTarget {
    /// Returns the lower bound from which on no refinement is needed.
    pub(crate) fn sufficient(&self) -> f64 {
        self.cap.min(self.upper * (1.0 - self.epsilon))
    }

    fn lower_upper_bound(&mut self, upper: f64) {
        if upper < self.upper {
            self.upper = upper;
        }
    }
}

/// Bounds triangle pairs. Owns the scratch memory for it.
pub(crate) struct PairRefiner<'m> {
    pub(super) model: &'m ScaledModel,
    /// The modes of the corners of sub-triangles: 18 rows.
    pub(super) corner_modes: Vec<f64>,
    pub(super) projections: CornerProjections,
    relative: RelativeModes,
    pub(super) affine: AffineBound,
    /// Sub-triangles by their lower bound and, to break ties, a serial number.
    open: BinaryHeap<MinHeapEntry<u32, SubPair>>,
    /// The first direction tried for the last pair, or the last one that made the pair's bound larger. None if the pair
    /// touches or, with a clearance, is not proven farther apart than it at rest.
    best_direction: Option<DVec3>,
}

impl<'m> PairRefiner<'m> {
    pub(crate) fn new(model: &'m ScaledModel) -> Self {
        let row_len = model.row_len;
        Self {
            model,
            corner_modes: vec![0.0; 6 * 3 * row_len],
            projections: CornerProjections::new(row_len),
            relative: RelativeModes::new(row_len),
            affine: AffineBound::new(row_len),
            open: BinaryHeap::new(),
            best_direction: None,
        }
    }

    /// Returns the first direction tried for the last pair, or the last one that made the pair's bound larger. None if
    /// the pair touches or, with a clearance, is not proven farther apart than it at rest.
    pub(crate) fn best_direction(&self) -> Option<DVec3> {
        self.best_direction
    }

    /// Returns a certified lower bound for two triangles, given by their vertices, refined as far as `target` needs. A smaller
    /// upper bound that it finds is stored in `target.upper`.
    pub(crate) fn refine(&mut self, a: [u32; 3], b: [u32; 3], target: &mut RefinementTarget) -> f64 {
        let pair = PairCorners::of(self.model, a, b);
        let lower = self.bound_corners(&pair, target);
        if lower >= target.sufficient() || lower <= 0.0 {
            return lower;
        }
        self.subdivide(&pair, lower, target)
    }

    /// Returns a certified lower bound without subdivision.
    pub(crate) fn bound(&mut self, a: [u32; 3], b: [u32; 3], target: &mut RefinementTarget) -> f64 {
        self.bound_corners(&PairCorners::of(self.model, a, b), target)
    }

    /// Subdivides best-first. Returns the smallest lower bound of the sub-triangles that remain.
    fn subdivide(&mut self, pair: &PairCorners<'_>, lower: f64, target: &mut RefinementTarget) -> f64 {
        let mut open = std::mem::take(&mut self.open);
        let mut corner_modes = std::mem::take(&mut self.corner_modes);
        open.clear();
        open.push(MinHeapEntry { key: lower, order: 0, item: SubPair::UNDIVIDED });
        let mut serial = 0;
        // The smallest bound of sub-triangles of the largest depth.
        let mut settled = f64::INFINITY;
        for step in 1..=target.subdivisions {
            let Some(entry) = open.pop() else { break };
            if entry.key >= target.sufficient().min(settled) || entry.key <= 0.0 {
                open.push(entry);
                break;
            }
            let MinHeapEntry { key: lower, item: part, .. } = entry;
            // Where the modes reach all directions, the bounds themselves find better upper bounds.
            if step.is_power_of_two() && !self.relative.can_reach_everywhere(pair) {
                // The ray ends at the cap, or well beyond the lower bound.
                let farthest = if target.cap.is_finite() { target.cap } else { 4.0 * lower };
                let part = part.corners(pair, &mut corner_modes);
                let z = &mut self.projections.rows[..self.model.row_len];
                let distance = self.model.required.at_rest();
                let ray = Ray { farthest, distance, z };
                if let Some(upper) = self.relative.bound_along_ray(pair, &part, ray) {
                    target.lower_upper_bound(upper);
                }
            }
            let is_a_divided = part.is_first_divided(pair);
            let depth = if is_a_divided { part.depth_a } else { part.depth_b };
            if depth >= MAX_DEPTH {
                settled = settled.min(lower);
                continue;
            }
            for item in part.subdivide(is_a_divided) {
                let bound = self.bound_corners(&item.corners(pair, &mut corner_modes), target);
                serial += 1;
                open.push(MinHeapEntry { key: bound.max(lower), order: serial, item });
            }
        }
        let lower = open.peek().map_or(settled, |entry| entry.key.min(settled));
        self.open = open;
        self.corner_modes = corner_modes;
        lower
    }

    /// Returns the largest of the cheap bounds of two (sub-)triangles.
    pub(super) fn bound_corners(&mut self, pair: &PairCorners<'_>, target: &mut RefinementTarget) -> f64 {
        self.best_direction = None;
        let model = self.model;
        let differences = pair.differences();
        // The rest distance, from the Euclidean closest points.
        let closest = nearest_to_origin(&differences);
        let Some(mut dir) = scale_direction(closest.point) else { return 0.0 };
        let rest_distance = bound_rest_distance(&differences, dir, &model.rounding);
        if rest_distance <= model.required.at_rest() {
            return 0.0;
        }
        let mut lower = bound_along(pair, &differences, dir, model.least_gap(dir), &mut self.projections);
        self.best_direction = Some(dir);
        if lower >= target.sufficient() {
            return lower;
        }
        // The affine bound is for near triangles; for others it is computed last, which is seldom necessary.
        let is_near = is_near(&differences, rest_distance);
        if is_near {
            lower = lower.max(self.affine.fit_and_bound(
                pair,
                &differences,
                rest_distance,
                target.sufficient(),
                model,
            ));
            if lower >= target.sufficient() {
                return lower;
            }
        }
        // Repeat with the closest points in the metric that the modes at the last closest points induce.
        let mut weights = closest.weights;
        for _ in 0..3 {
            let gram = self.relative.gram_at(pair, &weights);
            let ridge = 1e-6 * (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z);
            let metric = gram + DMat3::from_diagonal(DVec3::splat(ridge));
            let Some(factor) = inverse_factor(metric) else { break };
            // A clearance moves the other triangle nearer by its distance, along the last direction.
            let kept = dir.normalize_or_zero() * model.required.at_rest();
            let shifted = differences.map(|d| d - kept);
            let nearest = nearest_to_origin(&shifted.map(|d| factor * d));
            weights = nearest.weights;
            let Some(found) = scale_direction(factor.transpose() * nearest.point) else { break };
            dir = found;
            let better = bound_along(pair, &differences, dir, model.least_gap(dir), &mut self.projections);
            target.lower_upper_bound(self.relative.bound_at(pair, &shifted, &weights));
            let has_gained = better > lower * 1.001;
            if better > lower {
                self.best_direction = Some(dir);
                lower = better;
            }
            if lower >= target.sufficient() || !has_gained {
                break;
            }
        }
        if !is_near && lower < target.sufficient() {
            lower = lower.max(self.affine.fit_and_bound(
                pair,
                &differences,
                rest_distance,
                target.sufficient(),
                model,
            ));
        }
        lower
    }
}

/// Returns `L^-1` of the Cholesky factor L of a 3 x 3 matrix. None if the matrix is not positive definite.
fn inverse_factor(m: DMat3) -> Option<DMat3> {
    let l00 = m.x_axis.x.sqrt();
    let l10 = m.x_axis.y / l00;
    let l20 = m.x_axis.z / l00;
    let l11 = (m.y_axis.y - l10 * l10).sqrt();
    let l21 = (m.y_axis.z - l20 * l10) / l11;
    let l22 = (m.z_axis.z - l20 * l20 - l21 * l21).sqrt();
    let factor =
        DMat3::from_cols(DVec3::new(l00, l10, l20), DVec3::new(0.0, l11, l21), DVec3::new(0.0, 0.0, l22));
    let inverse = factor.inverse();
    (inverse.is_finite() && l00 > 0.0 && l11 > 0.0 && l22 > 0.0).then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::tests::random::Random;
    use crate::{DISTANCE_ERROR, Metric, Modes, ReducedModel, TriMesh};

    const FAR: RefinementTarget =
        RefinementTarget { cap: f64::INFINITY, upper: f64::INFINITY, epsilon: 0.1, subdivisions: 0 };

    /// Returns two triangles in scaled coordinates, with these displacements of each corner.
    fn scaled_model(p: &[DVec3; 6], displacements: [[DVec3; 3]; 6]) -> ScaledModel {
        let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let modes = Modes::new(3, displacements.concat()).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(3)).unwrap();
        ScaledModel::new(&model, model.metric(), &[0.0; 3])
    }

    /// Refinement ends at the cap, or within the tolerance of the upper bound.
    #[test]
    fn sufficient_bounds_are_within_the_tolerance() {
        for (cap, upper, sufficient) in [(2.0, 1.0, 0.75), (0.5, 1.0, 0.5), (2.0, f64::INFINITY, 2.0)] {
            let target = RefinementTarget { cap, upper, epsilon: 0.25, subdivisions: 0 };
            assert_eq!(target.sufficient(), sufficient, "{cap} {upper}");
        }
    }

    /// Three modes of any speed move one triangle along three axes, by different amounts: the radius is the
    /// distance in their metric. The first direction would prove much less; the bound and the upper bound are
    /// those of the best direction.
    #[test]
    fn bounds_of_translations_are_the_distance_in_their_metric() {
        let mut improved = 0;
        for case in 0..200 {
            let random = &mut Random::new(case);
            let p: [DVec3; 6] =
                std::array::from_fn(|v| random.vector() + DVec3::X * if v > 2 { 2.5 } else { 0.0 });
            let speed = random.power(-6.0, 6.0);
            let x = random.vector().normalize();
            let (y, z) = x.any_orthonormal_pair();
            // With a clearance all modes move equally fast.
            let is_keeping = case % 2 == 0;
            let moved = if is_keeping { [x, y, z] } else { [x, y * 0.3, z * 0.5] }.map(|u| u * speed);
            let scaled =
                scaled_model(&p, std::array::from_fn(|v| if v > 2 { moved } else { [DVec3::ZERO; 3] }));
            let differences = PairCorners::of(&scaled, [0, 1, 2], [3, 4, 5]).differences();
            let [x, y, z] = moved;
            let inverse = DMat3::from_cols(x, y, z).inverse();
            let free = nearest_to_origin(&differences.map(|d| inverse * d)).point.length();
            let (scaled, truth) = if is_keeping {
                (scaled.keeping(0.5 * free * speed, DISTANCE_ERROR), 0.5 * free)
            } else {
                (scaled, free)
            };
            let mut refiner = PairRefiner::new(&scaled);
            let mut target = FAR;
            let bound = refiner.bound([0, 1, 2], [3, 4, 5], &mut target);
            let is_near = |x: f64| (x / truth - 1.0).abs() <= 1e-6;
            assert!(bound <= truth * (1.0 + 1e-9) && is_near(bound), "case {case}: {bound:e} of {truth:e}");
            assert!(is_near(target.upper), "case {case}: {:e} of {truth:e}", target.upper);
            let dir = refiner.best_direction().unwrap();
            let pair = PairCorners::of(&scaled, [0, 1, 2], [3, 4, 5]);
            let mut along = |dir: DVec3| {
                bound_along(&pair, &differences, dir, scaled.least_gap(dir), &mut refiner.projections)
            };
            assert!(is_near(along(dir)), "case {case}: {dir}");
            improved += usize::from(along(nearest_to_origin(&differences).point) < 0.95 * truth);
        }
        assert!(improved > 50, "{improved}");
    }

    /// Two triangles of a plane that turns about all axes are far from each other. Along a fixed direction
    /// their bound is 3, by the affine map some hundred.
    #[test]
    fn affine_maps_are_tried_for_far_triangles_too() {
        let p = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [4.0, 0.0], [5.0, 0.0], [4.0, 1.0]]
            .map(|[x, y]| DVec3::new(x, y, 0.0));
        let scaled = scaled_model(&p, p.map(|p| DVec3::AXES.map(|axis| axis.cross(p))));
        let mut target = FAR;
        let bound = PairRefiner::new(&scaled).bound([0, 1, 2], [3, 4, 5], &mut target);
        assert!(bound > 50.0, "{bound}");
    }

    /// `L^-1 M L^-T` is the identity.
    #[test]
    fn inverse_factors_are_those_of_their_matrix() {
        let random = &mut Random::new(11);
        for case in 0..300 {
            let root = DMat3::from_cols(random.vector(), random.vector(), random.vector());
            let matrix = root * root.transpose() + DMat3::from_diagonal(DVec3::splat(0.1));
            let factor = inverse_factor(matrix).unwrap();
            let product = factor * matrix * factor.transpose();
            assert!(product.abs_diff_eq(DMat3::IDENTITY, 1e-10), "case {case}: {product}");
        }
        for diagonal in [DVec3::ZERO, DVec3::new(1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, 0.0), DVec3::NAN] {
            assert!(inverse_factor(DMat3::from_diagonal(diagonal)).is_none(), "{diagonal}");
        }
    }
}
