//! The certified bound for two triangles: cheap bounds first, subdivision only as far as it is needed.
//!
//! Replaces the constant-mode bound of the paper's section 5.1 and keeps its scheme: a lower and an upper
//! bound, and midpoint subdivision until they are close enough.

use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};

use super::affine::{AffineFit, affine_bound};
use super::contact_estimate::first_contact;
use super::leaf_pair::is_near;
use super::separating_direction::{TrianglePair, direction_bound, rest_distance};
use crate::geometry::nearest_to_origin;
use crate::heap::MinFirst;
use crate::model::rows::{add_scaled, dot, gram, project};
use crate::model::{ScaledModel, direction};

/// Triangles are halved at most this often in each direction, so corner weights stay exact.
const DEPTH: u8 = 20;

/// What a search still needs to know of a pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    /// Radii of at least this change nothing.
    pub(crate) cap: f64,
    /// The smallest upper bound found so far.
    pub(crate) upper: f64,
    /// Relative error allowed.
    pub(crate) epsilon: f64,
    /// Subdivisions of one triangle pair at the most. When they are used up the best lower bound so far
    /// stands: still certified, only less tight.
    pub(crate) subdivisions: usize,
}

impl Target {
    /// A lower bound of at least this needs no refinement.
    pub(crate) fn enough(&self) -> f64 {
        self.cap.min(self.upper * (1.0 - self.epsilon))
    }

    fn found(&mut self, upper: f64) {
        if upper < self.upper {
            self.upper = upper;
        }
    }
}

/// Corner weights of a sub-triangle over the corners of its triangle: multiples of 2^-20, exact.
pub(super) type Weights = [DVec3; 3];

pub(super) const WHOLE: Weights = [DVec3::X, DVec3::Y, DVec3::Z];

/// Sub-triangles of a triangle pair that are not refined yet; with their lower bound and, to break ties, a serial number
/// an entry of the heap.
struct Part {
    x: Weights,
    y: Weights,
    depth_x: u8,
    depth_y: u8,
}

/// Bounds triangle pairs; owns the scratch memory for it.
pub(crate) struct PairRefiner<'a> {
    model: &'a ScaledModel,
    corner_modes: Vec<f64>,
    projections: Vec<f64>,
    mean: Vec<f64>,
    affine: AffineFit,
    parts: BinaryHeap<MinFirst<u32, Part>>,
    /// The direction that bounded the last pair best.
    best: Option<DVec3>,
}

impl<'a> PairRefiner<'a> {
    pub(crate) fn new(model: &'a ScaledModel) -> Self {
        let row = model.row;
        Self {
            model,
            corner_modes: vec![0.0; 6 * 3 * row],
            projections: vec![0.0; 6 * row],
            mean: vec![0.0; 3 * row],
            affine: AffineFit::new(row),
            parts: BinaryHeap::new(),
            best: None,
        }
    }

    /// The direction that separates the last pair best.
    pub(crate) fn best_direction(&self) -> Option<DVec3> {
        self.best
    }

    fn pair(&self, x: [u32; 3], y: [u32; 3]) -> TrianglePair<'a> {
        let model = self.model;
        TrianglePair {
            x: x.map(|v| model.positions[v as usize]),
            y: y.map(|v| model.positions[v as usize]),
            modes_x: x.map(|v| model.modes(v)),
            modes_y: y.map(|v| model.modes(v)),
        }
    }

    /// A certified lower bound for two triangles, given by their vertices, refined as far as `target` asks; upper
    /// bounds met on the way lower `target.upper`.
    pub(crate) fn refine(&mut self, x: [u32; 3], y: [u32; 3], target: &mut Target) -> f64 {
        let pair = self.pair(x, y);
        let lower = self.bound(&pair, target);
        if lower >= target.enough() || lower <= 0.0 {
            return lower;
        }
        self.subdivide(&pair, lower, target)
    }

    /// The same without subdivision.
    pub(crate) fn bound_once(&mut self, x: [u32; 3], y: [u32; 3], target: &mut Target) -> f64 {
        let pair = self.pair(x, y);
        self.bound(&pair, target)
    }

    /// Best-first subdivision. The result is the smallest lower bound of the parts that remain.
    fn subdivide(&mut self, whole: &TrianglePair<'_>, lower: f64, target: &mut Target) -> f64 {
        let mut parts = std::mem::take(&mut self.parts);
        let mut corner_modes = std::mem::take(&mut self.corner_modes);
        parts.clear();
        let whole_pair = Part { x: WHOLE, y: WHOLE, depth_x: 0, depth_y: 0 };
        parts.push(MinFirst { key: lower, tie: 0, item: whole_pair });
        let mut serial = 0;
        // Parts that can be halved no further.
        let mut settled = f64::INFINITY;
        for step in 1..=target.subdivisions {
            let Some(entry) = parts.pop() else { break };
            if entry.key >= target.enough().min(settled) || entry.key <= 0.0 {
                parts.push(entry);
                break;
            }
            let MinFirst { key: lower, item: part, .. } = entry;
            // Where the modes reach all directions, the bounds themselves meet better upper bounds.
            if step.is_power_of_two() && !self.reaches_everywhere(whole) {
                self.reach_along_ray(whole, &part, lower, target, &mut corner_modes);
            }
            // Halve the part whose modes vary more, so that both shrink alike.
            let spread = |corners: &[&[f64]; 3], depth: u8| {
                let d = |a: usize, b: usize| crate::model::rows::squared_distance(corners[a], corners[b]);
                d(0, 1).max(d(1, 2)).max(d(0, 2)) * 0.25_f64.powi(i32::from(depth))
            };
            let split_x = spread(&whole.modes_x, part.depth_x) >= spread(&whole.modes_y, part.depth_y);
            let depth = if split_x { part.depth_x } else { part.depth_y };
            if depth >= DEPTH {
                settled = settled.min(lower);
                continue;
            }
            for quarter in quarters(if split_x { &part.x } else { &part.y }) {
                let (x, y) = if split_x { (quarter, part.y) } else { (part.x, quarter) };
                let bound = self.bound(&sub_pair(whole, &x, &y, &mut corner_modes), target);
                serial += 1;
                let depth_x = part.depth_x + u8::from(split_x);
                let depth_y = part.depth_y + u8::from(!split_x);
                let item = Part { x, y, depth_x, depth_y };
                parts.push(MinFirst { key: bound.max(lower), tie: serial, item });
            }
        }
        let lower = parts.peek().map_or(settled, |part| part.key.min(settled));
        self.parts = parts;
        self.corner_modes = corner_modes;
        lower
    }

    /// Whether the relative modes at the centroids move in all three directions.
    fn reaches_everywhere(&mut self, pair: &TrianglePair<'_>) -> bool {
        self.reach(pair, &pair.differences(), &[1.0 / 9.0; 9]).is_finite()
    }

    /// An upper bound where point pairs give none (rank 1 or 2, or modes that do not reach all directions): a z
    /// along which the part's closest points approach and at which the whole triangles first touch.
    fn reach_along_ray(
        &mut self,
        whole: &TrianglePair<'_>,
        part: &Part,
        lower: f64,
        target: &mut Target,
        corner_modes: &mut [f64],
    ) {
        let sub = sub_pair(whole, &part.x, &part.y, corner_modes);
        let differences = sub.differences();
        let closest = nearest_to_origin(&differences);
        self.gram_at(&sub, &closest.weights);
        let z = &mut self.projections[..self.model.row];
        project(&self.mean, closest.point, z);
        // As far as the triangles may move: to the cap, or well beyond the lower bound.
        let length = dot(z, z).sqrt();
        let farthest = if target.cap.is_finite() { target.cap } else { 4.0 * lower };
        let velocities = |modes: &[&[f64]; 3]| {
            modes.map(|modes| {
                let along = |c: usize| dot(&modes[c * z.len()..][..z.len()], z) * (-farthest / length);
                DVec3::new(along(0), along(1), along(2))
            })
        };
        let (vx, vy) = (velocities(&whole.modes_x), velocities(&whole.modes_y));
        let at = |p: &[DVec3; 3], v: &[DVec3; 3], t: f64| std::array::from_fn(|i| p[i] + v[i] * t);
        let contact = first_contact(|t| (at(&whole.x, &vx, t), at(&whole.y, &vy, t)));
        if let Some(t) = contact {
            target.found(t * farthest);
        }
    }

    /// The best of the cheap bounds for one pair of (sub-)triangles.
    fn bound(&mut self, pair: &TrianglePair<'_>, target: &mut Target) -> f64 {
        self.best = None;
        let error = self.model.error;
        let differences = pair.differences();
        // The rest gap, from the Euclidean closest points.
        let closest = nearest_to_origin(&differences);
        let Some(n) = direction(closest.point) else { return 0.0 };
        let delta = rest_distance(&differences, n, &error);
        if delta <= 0.0 {
            return 0.0;
        }
        let mut lower = direction_bound(pair, &differences, n, &error, &mut self.projections);
        self.best = Some(n);
        if lower >= target.enough() {
            return lower;
        }
        // The affine map is for near triangles; it is tried last on others, which seldom comes to that.
        let near = is_near(&differences, delta);
        if near {
            lower =
                lower.max(affine_bound(pair, &differences, delta, target.enough(), &error, &mut self.affine));
            if lower >= target.enough() {
                return lower;
            }
        }
        // Re-centre: the closest points in the metric that the modes at the last ones induce.
        let mut weights = closest.weights;
        for _ in 0..3 {
            let gram = self.gram_at(pair, &weights);
            let spread = 1e-6 * (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z);
            let metric = gram + DMat3::from_diagonal(DVec3::splat(spread));
            let Some(factor) = inverse_factor(metric) else { break };
            let stretched = differences.map(|d| factor * d);
            let nearest = nearest_to_origin(&stretched);
            weights = nearest.weights;
            let Some(n) = direction(factor.transpose() * nearest.point) else { break };
            let better = direction_bound(pair, &differences, n, &error, &mut self.projections);
            target.found(self.reach(pair, &differences, &weights));
            let gained = better > lower * 1.001;
            if better > lower {
                self.best = Some(n);
                lower = better;
            }
            if lower >= target.enough() || !gained {
                break;
            }
        }
        if !near && lower < target.enough() {
            lower =
                lower.max(affine_bound(pair, &differences, delta, target.enough(), &error, &mut self.affine));
        }
        lower
    }

    /// The Gram matrix of the relative modes at the points with the given weights.
    fn gram_at(&mut self, pair: &TrianglePair<'_>, weights: &[f64; 9]) -> DMat3 {
        self.mean.fill(0.0);
        for i in 0..3 {
            let x: f64 = weights[3 * i..3 * i + 3].iter().sum();
            let y: f64 = weights[i..].iter().step_by(3).sum();
            if x != 0.0 {
                add_scaled(&mut self.mean, -x, pair.modes_x[i]);
            }
            if y != 0.0 {
                add_scaled(&mut self.mean, y, pair.modes_y[i]);
            }
        }
        let [xx, xy, xz, yy, yz, zz] = gram(&self.mean);
        DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
    }

    /// An upper bound: the smallest `|z|` that brings the two points with the given weights together, `z = -B^+ d`.
    /// Infinite where the modes cannot move them in all directions (then upper bounds come from elsewhere).
    fn reach(&mut self, pair: &TrianglePair<'_>, differences: &[DVec3; 9], weights: &[f64; 9]) -> f64 {
        let gram = self.gram_at(pair, weights);
        let d: DVec3 = differences.iter().zip(weights).map(|(d, w)| *d * *w).sum();
        let scale = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        if gram.determinant() <= 1e-18 * scale * scale * scale {
            return f64::INFINITY;
        }
        let square = d.dot(gram.inverse() * d);
        if square > 0.0 { square.sqrt() } else { f64::INFINITY }
    }
}

/// The part of a pair with the given corner weights; its modes are written to `corner_modes` (18 rows).
pub(super) fn sub_pair<'b>(
    whole: &TrianglePair<'_>,
    x: &Weights,
    y: &Weights,
    corner_modes: &'b mut [f64],
) -> TrianglePair<'b> {
    let (modes_x, modes_y) = corner_modes.split_at_mut(corner_modes.len() / 2);
    TrianglePair {
        x: x.map(|w| combine(&whole.x, w)),
        y: y.map(|w| combine(&whole.y, w)),
        modes_x: combine_modes(&whole.modes_x, x, modes_x),
        modes_y: combine_modes(&whole.modes_y, y, modes_y),
    }
}

/// `L^-1` of the Cholesky factor of a 3 x 3 matrix, or none when it is not positive definite.
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

/// The four quarters of a triangle by edge midpoints, as corner weights.
pub(super) fn quarters(w: &Weights) -> [Weights; 4] {
    let [a, b, c] = *w;
    let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

fn combine(corners: &[DVec3; 3], w: DVec3) -> DVec3 {
    corners[0] * w.x + corners[1] * w.y + corners[2] * w.z
}

/// The modes at three points of a triangle, written to `out` (nine rows).
fn combine_modes<'b>(corners: &[&[f64]; 3], weights: &Weights, out: &'b mut [f64]) -> [&'b [f64]; 3] {
    let (first, rest) = out.split_at_mut(out.len() / 3);
    let (second, third) = rest.split_at_mut(first.len());
    for (out, w) in [&mut *first, &mut *second, &mut *third].into_iter().zip(weights) {
        let corners = corners[0].iter().zip(corners[1]).zip(corners[2]);
        for (out, ((a, b), c)) in out.iter_mut().zip(corners) {
            *out = a * w.x + b * w.y + c * w.z;
        }
    }
    [first, second, third]
}
