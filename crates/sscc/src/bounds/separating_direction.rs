//! The separating-direction bound of a triangle pair (replaces the constant-mode bound of the paper's section 5.1).
//!
//! For a fixed direction dir with `dir.d_ij > 0` for all nine pairs of corners (i of triangle a, j of triangle b):
//!
//! ```text
//! R_ab >= min over (i, j) of  dir.d_ij / |B_ij' dir|,    d_ij = p_j - p_i,  B_ij = A_j - A_i
//! ```
//!
//! Let t be the right-hand side. For `|z| < t` each computed corner of b lies beyond each computed corner of a along
//! dir, so dir separates the two triangles. The bound holds for any dir, any rank and any modes. Rounding is covered by
//! `(dir.d_ij - e0) / (|B_ij' dir| + e1)` with the two parts of the [`RoundingBound`]. A clearance needs a gap of more than
//! `D |dir|` in place of 0 (`required_gap.rs`), which adds `D |dir|` to e0: any two points of the triangles are convex combinations of
//! corners, so their gap along dir is at least the smallest of the nine, and their distance at least that over |dir|.
//! [`LeastGap`] contains e0 and e1 with both terms.

use glam::DVec3;

use super::pair_corners::PairCorners;
use crate::model::mode_rows::{project, squared_distance};
use crate::model::rounding::{ROUND_UP, norm_up, radius_down};
use crate::model::{LeastGap, RoundingBound};
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// The modes of six corners along a direction: scratch of six rows.
#[derive(Clone)]
pub(crate) struct CornerProjections {
    pub(super) instructions: InstructionSet,
    pub(super) rows: Vec<f64>,
}

impl CornerProjections {
    pub(crate) fn new(row_len: usize) -> Self {
        Self { instructions: InstructionSet::default(), rows: vec![0.0; 6 * row_len] }
    }
}

/// Returns the bound along a direction (from [`scale_direction`](crate::model::scale_direction)), given the gap that proves
/// points apart.
pub(crate) fn bound_along(
    pair: &PairCorners<'_>,
    differences: &[DVec3; 9],
    dir: DVec3,
    least: LeastGap,
    projections: &mut CornerProjections,
) -> f64 {
    let smallest = differences.iter().map(|d| dir.dot(*d)).fold(f64::INFINITY, f64::min);
    if smallest.is_nan() || smallest <= least.at_rest {
        return 0.0;
    }
    let CornerProjections { instructions, rows } = projections;
    instructions.run(CornerBound { pair, differences, dir, least, rows })
}

/// The smallest bound of nine pairs of corners along a direction.
struct CornerBound<'p, 'm> {
    pair: &'p PairCorners<'m>,
    differences: &'p [DVec3; 9],
    dir: DVec3,
    least: LeastGap,
    rows: &'p mut [f64],
}

impl Kernel for CornerBound<'_, '_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> f64 {
        let Self { pair, differences, dir, least, rows } = self;
        let row_len = rows.len() / 6;
        for (i, modes) in pair.modes_a.iter().chain(&pair.modes_b).enumerate() {
            project(modes, dir, &mut rows[i * row_len..][..row_len]);
        }
        let mut bound = f64::INFINITY;
        for (ij, d) in differences.iter().enumerate() {
            let [modes_i, modes_j] = [ij / 3, 3 + ij % 3].map(|corner| &rows[corner * row_len..][..row_len]);
            bound = bound.min(bound_points_along(dir.dot(*d), modes_i, modes_j, least));
        }
        bound
    }
}

/// Returns the bound of two points along a direction, from their gap and their modes projected on the direction.
#[inline(always)]
pub(super) fn bound_points_along(gap: f64, projected_i: &[f64], projected_j: &[f64], least: LeastGap) -> f64 {
    let gap = gap - with_mutant!(least.at_rest, DirectionWithoutRestError, 0.0);
    let rate = norm_up(squared_distance(projected_i, projected_j), projected_i.len());
    radius_down(gap, rate + with_mutant!(least.per_norm, DirectionWithoutRateError, 0.0))
}

/// Returns a lower bound of the rest distance of two triangles: the smallest gap along a direction over its length.
pub(super) fn bound_rest_distance(differences: &[DVec3; 9], dir: DVec3, rounding: &RoundingBound) -> f64 {
    let gap = differences.iter().map(|d| dir.dot(*d)).fold(f64::INFINITY, f64::min);
    radius_down(gap - rounding.at_rest(dir), dir.length() * ROUND_UP)
}
