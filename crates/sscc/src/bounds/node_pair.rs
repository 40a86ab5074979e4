//! The lower bound of a node pair. It replaces the estimate of the paper's section 5.2, which takes each mode alone and
//! is not conservative: modes combine.
//!
//! Every node has an AABB at rest with centre c and half extents h, and an affine map of its modes,
//! `A_i = A_c + G (p_i - c) + E_i`, with `|E_i' dir| <= rho(dir)` ([`NodeModes`]). A node therefore lies in the hull of
//! eight box corners with affine modes, up to the residual, and the separating-direction bound applies to corners as it
//! does to the corners of triangles:
//!
//! ```text
//! R_nm >= min over corners (i, j) of  (dir.d_ij - e0) / (|B_ij' dir| + rho_n(dir) + rho_m(dir) + e1)
//! ```
//!
//! A clearance D adds `D |dir|` to e0, and its rate to e1, as in `separating_direction.rs`: the gaps of all points of the two
//! hulls exceed it.
//!
//! Mean modes alone (`G = 0`) give much weaker bounds for nodes that are close: docs/notes/bounds.md#affine-bounds-and-directions.

use super::node_modes::NodeModes;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::mode_rows::{dot, gram, project};
use crate::model::rounding::{ROUND_UP, quotient_down};
use crate::model::{ScaledModel, scale_direction};
use crate::parallel;
use crate::vectors::{InstructionSet, Kernel, Vectors};
use glam::{DMat3, DVec3};

/// The affine modes of every node, from which pairs of nodes are bounded.
pub(crate) struct NodePairBounds {
    nodes: Vec<NodeModes>,
}

/// Scratch of one node pair.
pub(crate) struct NodePairScratch {
    pub(super) instructions: InstructionSet,
    /// The relative modes at the centres: three rows.
    difference: Vec<f64>,
    /// `B_0' dir` at the centres, then its change along the three axes of each box: seven rows.
    projections: Vec<f64>,
}

/// If the first direction gives less than this share of a sufficient bound, no other direction is tried
/// (docs/notes/bounds.md#affine-bounds-and-directions).
const LEAST_FIRST_SHARE: f64 = 0.8;

/// The number of corners of a box.
const CORNERS: usize = 8;

/// For each corner the side of the centre on which it lies along each axis.
const SIGNS: [[f64; 3]; CORNERS] = {
    let mut signs = [[1.0; 3]; CORNERS];
    let mut at = 0;
    while at < 3 * CORNERS {
        if (at / 3) >> (at % 3) & 1 == 1 {
            signs[at / 3][at % 3] = -1.0;
        }
        at += 1;
    }
    signs
};

/// For each axis the side of the centre on which each corner lies.
const SIDES: [[f64; CORNERS]; 3] = {
    let mut sides = [[1.0; CORNERS]; 3];
    let mut at = 0;
    while at < 3 * CORNERS {
        sides[at % 3][at / 3] = SIGNS[at / 3][at % 3];
        at += 1;
    }
    sides
};

impl NodePairScratch {
    pub(crate) fn new(row_len: usize) -> Self {
        Self {
            instructions: InstructionSet::default(),
            difference: vec![0.0; 3 * row_len],
            projections: vec![0.0; 7 * row_len],
        }
    }
}

impl NodePairBounds {
    pub(crate) fn new(model: &ScaledModel, hierarchy: &Hierarchy) -> Self {
        let fit = |node| NodeModes::fit(model, &hierarchy.vertices(node, &model.faces));
        Self { nodes: parallel::map(hierarchy.nodes(), fit) }
    }

    /// Returns the squared half diagonal of a node's AABB at rest: the measure by which one of two nodes is larger.
    pub(crate) fn size(&self, n: u32) -> f64 {
        self.nodes[n as usize].half.length_squared()
    }

    /// Whether the AABBs of two nodes touch or overlap at the centre.
    pub(crate) fn are_touching(&self, (n, m): NodePair) -> bool {
        self.nodes[n as usize].gap(&self.nodes[m as usize]) == DVec3::ZERO
    }

    /// Returns the best direction to separate two points whose difference is the gap vector of the AABBs. None if the AABBs
    /// touch.
    pub(crate) fn direction(&self, n: u32, m: u32, scratch: &mut NodePairScratch) -> Option<DVec3> {
        let (n, m) = (&self.nodes[n as usize], &self.nodes[m as usize]);
        let gap = n.gap(m);
        let inverse = inverse_gram(n, m, scratch);
        if gap == DVec3::ZERO { None } else { scale_direction(inverse * gap) }
    }

    /// Returns the modes of a node.
    pub(crate) fn of_node(&self, n: u32) -> &NodeModes {
        &self.nodes[n as usize]
    }

    /// Returns a direction that proves two nodes apart below a radius, if one of the candidates does.
    pub(crate) fn witness(
        &self,
        model: &ScaledModel,
        (n, m): NodePair,
        radius: f64,
        scratch: &mut NodePairScratch,
    ) -> Option<DVec3> {
        let (n, m) = (&self.nodes[n as usize], &self.nodes[m as usize]);
        scratch.instructions.run(NodeWitness { n, m, radius, model, scratch })
    }

    /// Returns a certified lower bound for two nodes. The search for a larger bound ends at `sufficient`.
    pub(crate) fn bound(
        &self,
        model: &ScaledModel,
        n: u32,
        m: u32,
        sufficient: f64,
        scratch: &mut NodePairScratch,
    ) -> f64 {
        let (n, m) = (&self.nodes[n as usize], &self.nodes[m as usize]);
        scratch.instructions.run(NodeBound { n, m, sufficient, model, scratch })
    }
}

/// The bound of two nodes.
struct NodeBound<'n> {
    n: &'n NodeModes,
    m: &'n NodeModes,
    sufficient: f64,
    model: &'n ScaledModel,
    scratch: &'n mut NodePairScratch,
}

impl Kernel for NodeBound<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> f64 {
        let Self { n, m, sufficient, model, scratch } = self;
        let mut best = 0.0_f64;
        for dir in candidates(n, m, scratch) {
            best = best.max(bound_corners_along(n, m, dir, model, scratch));
            // The first direction is usually the best one: where it gives little, so do the others.
            if best >= sufficient || best < LEAST_FIRST_SHARE * sufficient {
                break;
            }
        }
        best
    }
}

/// A direction for which the bound of two nodes is at least a radius.
struct NodeWitness<'n> {
    n: &'n NodeModes,
    m: &'n NodeModes,
    radius: f64,
    model: &'n ScaledModel,
    scratch: &'n mut NodePairScratch,
}

impl Kernel for NodeWitness<'_> {
    type Output = Option<DVec3>;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> Option<DVec3> {
        let Self { n, m, radius, model, scratch } = self;
        let mut directions = candidates(n, m, scratch);
        directions.find(|dir| bound_corners_along(n, m, *dir, model, scratch) >= radius)
    }
}

/// Returns the candidate directions that separate the AABBs; there are none if the AABBs touch.
#[inline(always)]
fn candidates(
    n: &NodeModes,
    m: &NodeModes,
    scratch: &mut NodePairScratch,
) -> impl Iterator<Item = DVec3> + use<> {
    let between = m.center - n.center;
    let half = n.half + m.half;
    let gap = n.gap(m);
    let inverse = if gap == DVec3::ZERO { DMat3::ZERO } else { inverse_gram(n, m, scratch) };
    // Half extents are larger than those of the boxes, so this gap is smaller than that of the boxes.
    let is_separating = move |dir: &DVec3| dir.dot(between) - dir.abs().dot(half) > 0.0;
    let tried = [inverse * between, inverse * gap, between, gap].into_iter();
    tried.filter(move |_| gap != DVec3::ZERO).filter_map(scale_direction).filter(is_separating)
}

/// Returns the inverse of the regularised Gram matrix of the relative modes at the centres: in that metric the best direction for
/// points with the difference d is `gram^-1 d`.
#[inline(always)]
fn inverse_gram(n: &NodeModes, m: &NodeModes, scratch: &mut NodePairScratch) -> DMat3 {
    for ((d, a), b) in scratch.difference.iter_mut().zip(&m.modes).zip(&n.modes) {
        *d = a - b;
    }
    let mut metric = gram(&scratch.difference);
    let trace = metric.x_axis.x + metric.y_axis.y + metric.z_axis.z;
    let ridge = 1e-3 * trace + f64::MIN_POSITIVE;
    metric.x_axis.x += ridge;
    metric.y_axis.y += ridge;
    metric.z_axis.z += ridge;
    metric.inverse()
}

/// Returns the bound along one direction: the smallest of the 64 pairs of corners.
#[inline(always)]
fn bound_corners_along(
    n: &NodeModes,
    m: &NodeModes,
    dir: DVec3,
    model: &ScaledModel,
    scratch: &mut NodePairScratch,
) -> f64 {
    let row_len = model.row_len;
    let (center, axes) = scratch.projections.split_at_mut(row_len);
    project(&scratch.difference, dir, center);
    // Steps of the gap and of B'dir from the centres to a corner, one for each axis of each box.
    let mut steps = [0.0; 6];
    for (i, out) in axes.chunks_exact_mut(row_len).enumerate() {
        let (node, axis, sign) = if i < 3 { (m, i, 1.0) } else { (n, i - 3, -1.0) };
        steps[i] = sign * dir[axis] * node.half[axis];
        project(&node.gradient[3 * axis * row_len..][..3 * row_len], dir * (sign * node.half[axis]), out);
    }
    // Norms at the corners come from the Gram matrix of these seven rows. Where they cancel, its error is
    // relative to the rows, not to the result: the term `lost` covers it.
    let rows = |i: usize| &scratch.projections[i * row_len..][..row_len];
    let mut products = [[0.0; 7]; 7];
    for i in 0..7 {
        for j in i..7 {
            products[i][j] = dot(rows(i), rows(j));
            products[j][i] = products[i][j];
        }
    }
    let size: f64 = (0..7).map(|i| products[i][i].sqrt()).sum();
    // The terms of a square add up to at most (the sum of all |row|)^2; the products err by row eps of that, and
    // at most 16 sums follow one another: 2,000 is more than needed.
    let lost =
        with_mutant!((row_len as f64 + 2_000.0) * f64::EPSILON * size * size, NodePairProductsExact, 0.0);
    let required = with_mutant!(model.required.along(dir), NodePairWithoutClearance, Default::default());
    let per_norm =
        with_mutant!(2.0 * model.rounding.per_norm(dir), NodePairWithoutRateError, 0.0) + required.per_norm;
    let slack = dir.abs().dot(n.residual + m.residual) + per_norm;
    let at_rest =
        with_mutant!(2.0 * model.rounding.at_rest(dir), NodePairWithoutRestError, 0.0) + required.at_rest;
    let gap = dir.dot(m.center - n.center);
    // For corners M of m and N of n, `|c + M + N|^2 = |c|^2 + (|c + M|^2 - |c|^2) + (|c + N|^2 - |c|^2) + 2 M.N`.
    let [(steps_m, squares_m), (steps_n, squares_n)] = [0, 3].map(|first| {
        let (mut sums, mut squares) = ([0.0; CORNERS], [0.0; CORNERS]);
        for (corner, signs) in SIGNS.iter().enumerate() {
            for i in 0..3 {
                sums[corner] += signs[i] * steps[first + i];
                let row = &products[1 + first + i];
                let others: f64 = (0..i).map(|j| signs[j] * row[1 + first + j]).sum();
                squares[corner] += 2.0 * signs[i] * (row[0] + others) + row[1 + first + i];
            }
        }
        (sums, squares)
    });
    // Gap over rate as in `radius_down`, lane by lane without a branch: its conditions are checked once for all corners.
    let (mut smallest_gap, mut smallest_radius, mut rates) =
        ([f64::INFINITY; CORNERS], [f64::INFINITY; CORNERS], [0.0; CORNERS]);
    for (corner_m, signs) in SIGNS.iter().enumerate() {
        let cross: [f64; 3] =
            std::array::from_fn(|j| 2.0 * (0..3).map(|i| signs[i] * products[1 + i][4 + j]).sum::<f64>());
        let (own_gap, own_square) = (gap + steps_m[corner_m], products[0][0] + squares_m[corner_m]);
        for i in 0..CORNERS {
            let both = SIDES[0][i] * cross[0] + SIDES[1][i] * cross[1] + SIDES[2][i] * cross[2];
            let square = own_square + squares_n[i] + both;
            let square = if square < 0.0 { 0.0 } else { square };
            let rate = ((square + lost).sqrt() + slack) * ROUND_UP;
            let gap = own_gap + steps_n[i] - at_rest;
            let radius = gap / rate;
            smallest_gap[i] = if gap < smallest_gap[i] { gap } else { smallest_gap[i] };
            smallest_radius[i] = if radius < smallest_radius[i] { radius } else { smallest_radius[i] };
            rates[i] += rate;
        }
    }
    let smallest = |lanes: [f64; CORNERS]| lanes.into_iter().fold(f64::INFINITY, f64::min);
    // A rate that is NaN makes the sum of rates NaN, too; gaps are finite where their rounding bound is.
    if smallest(smallest_gap) > 0.0 && rates.into_iter().sum::<f64>() >= 0.0 && (gap - at_rest).is_finite() {
        quotient_down(smallest(smallest_radius), 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
