//! The bound for two nodes of the hierarchy (replaces the single-mode estimate of the paper's section 5.2, which
//! is not conservative: modes combine).
//!
//! Every node has a rest box with centre c and half extents h, and an affine map of its modes,
//! `A_v = A_c + G (p_v - c) + E_v`, with `|E_v' n| <= rho(n)`. A node therefore lies in the hull of eight box corners
//! with affine modes, up to the residual, and the separating-direction bound applies to corners as it does to the
//! corners of triangles:
//!
//! ```text
//! R(X, Y) >= min over corners (a, b) of  (n.d_ab - e0) / (|B_ab' n| + rho_X(n) + rho_Y(n) + e1)
//! ```
//!
//! With mean modes alone (`G = 0`) a pair had to be about 19 times farther apart than it is large before its
//! bound came within 10% of the truth, because gap and closing rate shrink together towards the near
//! corners: the bunny (24 modes) took 4.1 million node pairs and 6.1 million triangle pairs, with this 0.4 and 0.5.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::model::rows::{add_scaled, dot, gram, project};
use crate::model::{ScaledModel, UP, direction, norm_up, quotient_down};

/// What is known of one node. Rows are over the modes.
struct Cluster {
    centre: DVec3,
    half: DVec3,
    /// `|E_v' n| <= n.abs().dot(residual)`
    residual: DVec3,
    /// Modes at the centre: three rows.
    modes: Vec<f64>,
    /// Three rows for each direction j: `(G e_j)_c` at `3 j + c`.
    gradient: Vec<f64>,
}

/// Box, affine modes and residuals of every node.
pub(crate) struct ClusterBounds {
    clusters: Vec<Cluster>,
}

impl ClusterBounds {
    pub(crate) fn new(model: &ScaledModel, hierarchy: &Hierarchy) -> Self {
        let cluster = |node| {
            let vertices = hierarchy.vertices(node, &model.faces);
            Cluster::fit(model, &vertices)
        };
        Self { clusters: hierarchy.nodes().par_iter().map(cluster).collect() }
    }

    /// A direction between two nodes, the best one for points as far apart as their boxes; none where these touch.
    pub(crate) fn direction(&self, x: u32, y: u32, scratch: &mut ClusterScratch) -> Option<DVec3> {
        let (x, y) = (&self.clusters[x as usize], &self.clusters[y as usize]);
        let apart = boxes_apart(x, y);
        let inverse = inverse_gram(x, y, scratch);
        if apart == DVec3::ZERO { None } else { direction(inverse * apart) }
    }

    /// The squared diagonal of the rest box: which of two nodes is larger.
    pub(crate) fn size(&self, node: u32) -> f64 {
        self.clusters[node as usize].half.length_squared()
    }
}

impl Cluster {
    fn fit(model: &ScaledModel, vertices: &[u32]) -> Self {
        let row = model.row;
        let Aabb { lower, upper } = Aabb::of_points(vertices.iter().map(|&v| model.positions[v as usize]));
        let centre = lower * 0.5 + upper * 0.5;
        // A little larger than the difference of the rounded corners.
        let half = (upper - centre).max(centre - lower) * UP;
        let count = vertices.len() as f64;
        let mean = vertices.iter().map(|&v| model.positions[v as usize] - centre).sum::<DVec3>() / count;
        let mut moment = DMat3::ZERO;
        for &v in vertices {
            let d = model.positions[v as usize] - centre - mean;
            moment += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        }
        let trace = moment.x_axis.x + moment.y_axis.y + moment.z_axis.z;
        // Vertices nearly in a plane say nothing about the gradient across it: keep that part small.
        let inverse = (moment + DMat3::from_diagonal(DVec3::splat(1e-4 * trace))).inverse();
        let mut modes = vec![0.0; 3 * row];
        let mut gradient = vec![0.0; 9 * row];
        for &v in vertices {
            let a = model.modes(v);
            let fit = inverse * (model.positions[v as usize] - centre - mean);
            add_scaled(&mut modes, 1.0 / count, a);
            if fit.is_finite() {
                for (j, rows) in gradient.chunks_exact_mut(3 * row).enumerate() {
                    add_scaled(rows, fit[j], a);
                }
            }
        }
        for (j, rows) in gradient.chunks_exact(3 * row).enumerate() {
            add_scaled(&mut modes, -mean[j], rows);
        }
        let mut residual = DVec3::ZERO;
        let mut rest = vec![0.0; 3 * row];
        for &v in vertices {
            let offset = model.positions[v as usize] - centre;
            rest.iter_mut().zip(model.modes(v)).zip(&modes).for_each(|((e, a), m)| *e = a - m);
            for (j, rows) in gradient.chunks_exact(3 * row).enumerate() {
                add_scaled(&mut rest, -offset[j], rows);
            }
            let norm = |c: usize| {
                let e = &rest[c * row..][..row];
                norm_up(dot(e, e), row)
            };
            residual = residual.max(DVec3::new(norm(0), norm(1), norm(2)));
        }
        // Rounding of residuals and corners: relative to the modes it is covered by the rate error, relative
        // to `|G| |h|` by this.
        let frobenius = norm_up(dot(&gradient, &gradient), 9 * row);
        let lost = right_or!(64.0 * f64::EPSILON * frobenius * half.length(), ClusterFitExact, 0.0);
        residual += DVec3::splat(lost);
        Self { centre, half, residual, modes, gradient }
    }
}

/// Below this share of what would be enough no other direction is tried. With half of it certificates of the dragon
/// take 1.1 times as long.
const HOPELESS: f64 = 0.8;

/// Corners of a box.
const CORNERS: usize = 8;

/// On which side of the centre each of them lies.
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

/// The same by axes.
const SIDES: [[f64; CORNERS]; 3] = {
    let mut sides = [[1.0; CORNERS]; 3];
    let mut at = 0;
    while at < 3 * CORNERS {
        sides[at % 3][at / 3] = SIGNS[at / 3][at % 3];
        at += 1;
    }
    sides
};

/// Scratch of one pair.
pub(crate) struct ClusterScratch {
    difference: Vec<f64>,
    /// `B_0' n` at the centres, then how it changes along the three axes of each box.
    projections: Vec<f64>,
}

impl ClusterScratch {
    pub(crate) fn new(row: usize) -> Self {
        Self { difference: vec![0.0; 3 * row], projections: vec![0.0; 7 * row] }
    }
}

/// A certified bound for two nodes; stops looking for a better one at `enough`.
pub(crate) fn cluster_pair(
    bounds: &ClusterBounds,
    model: &ScaledModel,
    x: u32,
    y: u32,
    enough: f64,
    scratch: &mut ClusterScratch,
) -> f64 {
    let (x, y) = (&bounds.clusters[x as usize], &bounds.clusters[y as usize]);
    let between = y.centre - x.centre;
    let half = x.half + y.half;
    let apart = boxes_apart(x, y);
    if apart == DVec3::ZERO {
        return 0.0;
    }
    let inverse = inverse_gram(x, y, scratch);
    let mut best = 0.0_f64;
    for candidate in [inverse * between, inverse * apart, between, apart] {
        let Some(n) = direction(candidate) else { continue };
        // Half extents are larger than the boxes, so this gap is smaller than theirs.
        if n.dot(between) - n.abs().dot(half) > 0.0 {
            best = best.max(corner_bound(x, y, n, model, scratch));
            // Far too little by the direction that is best as a rule: the others seldom do.
            if best >= enough || best < HOPELESS * enough {
                break;
            }
        }
    }
    best
}

/// The vector between the closest points of two boxes; 0 where they touch.
fn boxes_apart(x: &Cluster, y: &Cluster) -> DVec3 {
    let (between, half) = (y.centre - x.centre, x.half + y.half);
    (between - half).max(DVec3::ZERO) + (between + half).min(DVec3::ZERO)
}

/// In the metric of the relative modes at the centres the best direction for points d apart is `gram^-1 d`.
fn inverse_gram(x: &Cluster, y: &Cluster, scratch: &mut ClusterScratch) -> DMat3 {
    for ((d, a), b) in scratch.difference.iter_mut().zip(&y.modes).zip(&x.modes) {
        *d = a - b;
    }
    let [xx, xy, xz, yy, yz, zz] = gram(&scratch.difference);
    let ridge = 1e-3 * (xx + yy + zz) + f64::MIN_POSITIVE;
    let metric = DMat3::from_cols(
        DVec3::new(xx + ridge, xy, xz),
        DVec3::new(xy, yy + ridge, yz),
        DVec3::new(xz, yz, zz + ridge),
    );
    metric.inverse()
}

/// The bound for one direction: the least of the 64 pairs of corners.
fn corner_bound(
    x: &Cluster,
    y: &Cluster,
    n: DVec3,
    model: &ScaledModel,
    scratch: &mut ClusterScratch,
) -> f64 {
    let row = model.row;
    let (centre, axes) = scratch.projections.split_at_mut(row);
    project(&scratch.difference, n, centre);
    // Steps of the gap and of B'n from the centres to a corner, one for each axis of each box.
    let mut steps = [0.0; 6];
    for (i, out) in axes.chunks_exact_mut(row).enumerate() {
        let (cluster, j, sign) = if i < 3 { (y, i, 1.0) } else { (x, i - 3, -1.0) };
        steps[i] = sign * n[j] * cluster.half[j];
        project(&cluster.gradient[3 * j * row..][..3 * row], n * (sign * cluster.half[j]), out);
    }
    // Norms at the corners come from the Gram matrix of these seven rows. Where they cancel, its error is
    // relative to the rows, not to the result: the term `lost` covers it.
    let rows = |i: usize| &scratch.projections[i * row..][..row];
    let mut products = [[0.0; 7]; 7];
    for i in 0..7 {
        for j in i..7 {
            products[i][j] = dot(rows(i), rows(j));
            products[j][i] = products[i][j];
        }
    }
    let size: f64 = (0..7).map(|i| products[i][i].sqrt()).sum();
    // The terms of a square add up to at most (the sum of all |row|)^2; the products are wrong by row eps of that, and
    // at most 16 sums follow one another: 2,000 leaves room.
    let lost = right_or!((row as f64 + 2_000.0) * f64::EPSILON * size * size, ClusterProductsExact, 0.0);
    let rate_error = right_or!(2.0 * model.error.rate(n), ClusterWithoutRateError, 0.0);
    let slack = n.abs().dot(x.residual + y.residual) + rate_error;
    let rest_error = right_or!(2.0 * model.error.rest(n), ClusterWithoutRestError, 0.0);
    let gap = n.dot(y.centre - x.centre);
    // For corners Y of y and X of x, `|c + Y + X|^2 = |c|^2 + (|c + Y|^2 - |c|^2) + (|c + X|^2 - |c|^2) + 2 Y.X`.
    let [(steps_y, squares_y), (steps_x, squares_x)] = [0, 3].map(|first| {
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
    // Lane by lane without a branch: gap over rate as in `radius`, but what it asks is asked once of all corners.
    let (mut least_gap, mut least_radius, mut rates) =
        ([f64::INFINITY; CORNERS], [f64::INFINITY; CORNERS], [0.0; CORNERS]);
    for (at_y, signs) in SIGNS.iter().enumerate() {
        let cross: [f64; 3] =
            std::array::from_fn(|j| 2.0 * (0..3).map(|i| signs[i] * products[1 + i][4 + j]).sum::<f64>());
        let (own_gap, own_square) = (gap + steps_y[at_y], products[0][0] + squares_y[at_y]);
        for i in 0..CORNERS {
            let both = SIDES[0][i] * cross[0] + SIDES[1][i] * cross[1] + SIDES[2][i] * cross[2];
            let square = own_square + squares_x[i] + both;
            let square = if square < 0.0 { 0.0 } else { square };
            let rate = ((square + lost).sqrt() + slack) * UP;
            let gap = own_gap + steps_x[i] - rest_error;
            let radius = gap / rate;
            least_gap[i] = if gap < least_gap[i] { gap } else { least_gap[i] };
            least_radius[i] = if radius < least_radius[i] { radius } else { least_radius[i] };
            rates[i] += rate;
        }
    }
    let least = |lanes: [f64; CORNERS]| lanes.into_iter().fold(f64::INFINITY, f64::min);
    // A rate that is not a number makes their sum none, too; gaps are finite where their error is.
    if least(least_gap) > 0.0 && rates.into_iter().sum::<f64>() >= 0.0 && (gap - rest_error).is_finite() {
        quotient_down(least(least_radius), 1.0)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
