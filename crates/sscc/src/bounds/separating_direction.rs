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

#[cfg(test)]
mod tests {
    use sscc_testing::Dyadic;

    use super::*;
    use crate::bounds::tests::random::Random;
    use crate::geometry::TwoTriangles;

    /// The bound of two points is at most the gap less its part at rest, over the rate and its part per norm, and close
    /// to it. That of two triangles is the smallest of their corners.
    #[test]
    fn bounds_along_a_direction_are_gaps_over_rates() {
        let mut positive = 0;
        for case in 0..200 {
            let random = &mut Random::new(case);
            let row_len = 4 * (1 + random.below(4));
            let modes: [Vec<f64>; 6] =
                std::array::from_fn(|_| (0..3 * row_len).map(|_| random.uniform() - 0.5).collect());
            let side = DVec3::X * (1.0 + 3.0 * random.uniform());
            let corners = TwoTriangles {
                a: std::array::from_fn(|_| random.vector()),
                b: std::array::from_fn(|_| random.vector() + side),
            };
            let [a0, a1, a2, b0, b1, b2] = modes.each_ref().map(Vec::as_slice);
            let pair = PairCorners { corners, modes_a: [a0, a1, a2], modes_b: [b0, b1, b2] };
            let dir = DVec3::X + random.vector() * 0.3;
            let least = LeastGap { at_rest: 0.3 * random.uniform(), per_norm: random.uniform() };
            let projected = modes.each_ref().map(|modes| -> Vec<f64> {
                let along = |k: usize, axis: usize| dir[axis] * modes[axis * row_len + k];
                (0..row_len).map(|k| along(k, 0) + along(k, 1) + along(k, 2)).collect()
            });
            let mut smallest = f64::INFINITY;
            for (i, j) in (0..9).map(|ij| (ij / 3, ij % 3)) {
                let gap = dir.dot(corners.b[j] - corners.a[i]);
                let (x, y) = (&projected[i], &projected[3 + j]);
                let rate = x.iter().zip(y).map(|(x, y)| (y - x) * (y - x)).sum::<f64>().sqrt();
                let wanted = (gap - least.at_rest).max(0.0) / (rate + least.per_norm);
                let bound = bound_points_along(gap, x, y, least);
                assert!(bound <= wanted && bound >= wanted * (1.0 - 1e-12), "case {case}: {bound:e}");
                smallest = smallest.min(wanted);
            }
            let mut projections = CornerProjections::new(row_len);
            let bound = bound_along(&pair, &pair.differences(), dir, least, &mut projections);
            let error = (bound - smallest).abs();
            assert!(error <= 1e-9 * smallest + 1e-12, "case {case}: {bound:e}, not {smallest:e}");
            positive += usize::from(smallest > 0.0);
        }
        assert!(positive > 50 && positive < 190, "{positive}");
    }

    /// The rest distance is at most the smallest gap over the length of the direction, in exact arithmetic, and close
    /// to it.
    #[test]
    fn rest_distances_are_rounded_down() {
        let none = RoundingBound::new(DVec3::ZERO, DVec3::ZERO, 1);
        let exact = Dyadic::new;
        let larger = exact(1.0 + 1e-14);
        for case in 0..300 {
            let random = &mut Random::new(case);
            // Gaps of so small integers are exact.
            let mut integers = || (random.vector() * 500.0).round();
            let dir = integers().abs() + DVec3::X;
            let differences: [DVec3; 9] = std::array::from_fn(|_| integers().abs() + DVec3::X);
            let smallest = differences.iter().map(|d| dir.dot(*d)).fold(f64::INFINITY, f64::min);
            let distance = exact(bound_rest_distance(&differences, dir, &none));
            let (square, length) = (exact(smallest) * exact(smallest), exact(dir.length_squared()));
            assert!(&distance * &distance * &length <= square, "case {case}");
            assert!(&distance * &distance * &length * &larger * &larger >= square, "case {case}");
        }
    }
}
