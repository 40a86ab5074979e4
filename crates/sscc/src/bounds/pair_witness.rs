//! Witnesses prove that the bound of a triangle pair is at least a radius. A program that does not trust the bounds checks the
//! witnesses.

use glam::DVec3;

use super::affine_bound::AffinePair;
use super::pair_corners::PairCorners;
use super::pair_refiner::{PairRefiner, RefinementTarget};
use super::separating_direction::{bound_along, bound_rest_distance};
use super::sub_triangle::{MAX_DEPTH, SubPair};
use crate::geometry::nearest_to_origin;
use crate::model::rounding::larger_or_nan;
use crate::model::scale_direction;

/// A proof that two (sub-)triangles stay apart below a radius.
#[derive(Clone, Debug)]
pub(crate) enum PairWitness {
    /// A direction of the list separates all corners.
    Known(usize),
    /// A direction, which is added to the list.
    Direction(DVec3),
    /// An affine map (nine rows, `G_cj` at `3 c + j`), a direction along which the triangles have a gap, and the rate of the map
    /// over all directions of a pyramid.
    Affine { gradient: Vec<f64>, dir: DVec3, rate: f64, pyramid: [DVec3; 4] },
    /// The first triangle is quartered, or the second one; the witnesses of the four parts follow.
    Quarters { is_first: bool },
}

/// The witnesses of some pairs, in the order in which they are checked.
#[derive(Debug, Default)]
pub(crate) struct WitnessList {
    pub(crate) witnesses: Vec<PairWitness>,
    directions: Vec<DVec3>,
}

/// Number of directions of the list that are tried for a pair: the last ones among the first [`MAX_DIRECTIONS`].
const DIRECTIONS_TRIED: usize = 6;
/// Maximum number of parts of two triangles. The search of a radius divides a pair at most 500 times into four; only a radius that is
/// nearer to the exact one than any search comes needs more.
const MAX_PARTS: usize = 1 << 14;
/// Maximum number of directions to which witnesses refer by their numbers.
const MAX_DIRECTIONS: usize = 251;

impl PairRefiner<'_> {
    /// Appends witnesses for two triangles (or simplices), given by their vertices. Returns false if no witness is
    /// found for some part; then the list ends with the witnesses of other parts, which prove nothing.
    pub(crate) fn prove(&mut self, a: [u32; 3], b: [u32; 3], radius: f64, list: &mut WitnessList) -> bool {
        let pair = PairCorners::of(self.model, a, b);
        let mut corner_modes = std::mem::take(&mut self.corner_modes);
        let limit = list.witnesses.len() + MAX_PARTS;
        let is_proven = self.prove_part(&pair, SubPair::UNDIVIDED, radius, list, limit, &mut corner_modes);
        self.corner_modes = corner_modes;
        is_proven
    }

    fn prove_part(
        &mut self,
        pair: &PairCorners<'_>,
        part: SubPair,
        radius: f64,
        list: &mut WitnessList,
        limit: usize,
        corner_modes: &mut [f64],
    ) -> bool {
        if list.witnesses.len() >= limit {
            return false;
        }
        let is_whole = part.depth_a == 0 && part.depth_b == 0;
        let corners = if is_whole { *pair } else { part.corners(pair, corner_modes) };
        if let Some(witness) = self.witness(&corners, radius, &list.directions) {
            if let PairWitness::Direction(dir) = witness {
                list.directions.push(dir);
            }
            list.witnesses.push(witness);
            return true;
        }
        let is_first = part.is_first_divided(pair);
        if (if is_first { part.depth_a } else { part.depth_b }) >= MAX_DEPTH {
            return false;
        }
        list.witnesses.push(PairWitness::Quarters { is_first });
        let mut parts = part.subdivide(is_first).into_iter();
        parts.all(|part| self.prove_part(pair, part, radius, list, limit, corner_modes))
    }

    /// Returns a witness for these corners without subdivision.
    fn witness(&mut self, pair: &PairCorners<'_>, radius: f64, known: &[DVec3]) -> Option<PairWitness> {
        let model = self.model;
        let differences = pair.differences();
        let mut separates = |dir: DVec3| {
            bound_along(pair, &differences, dir, model.least_gap(dir), &mut self.projections) >= radius
        };
        let known = &known[..known.len().min(MAX_DIRECTIONS)];
        let numbers = (0..known.len()).rev().take(DIRECTIONS_TRIED);
        if let Some(number) = numbers.into_iter().find(|number| separates(known[*number])) {
            return Some(PairWitness::Known(number));
        }
        let mut target =
            RefinementTarget { cap: radius, upper: f64::INFINITY, epsilon: 0.0, subdivisions: 0 };
        if self.bound_corners(pair, &mut target) < radius {
            return None;
        }
        if let Some(dir) = self.best_direction()
            && bound_along(pair, &differences, dir, model.least_gap(dir), &mut self.projections) >= radius
        {
            return Some(PairWitness::Direction(dir));
        }
        // The bound is that of the affine map of these corners.
        let dir = scale_direction(nearest_to_origin(&differences).point)?;
        let rest_distance = bound_rest_distance(&differences, dir, &model.rounding);
        let mut squared_residual = 0.0_f64;
        for (i, j) in (0..9).map(|ij| (ij / 3, 3 + ij % 3)) {
            squared_residual = larger_or_nan(squared_residual, self.affine.squared_residual(i, j));
        }
        let near = AffinePair { differences: &differences, rest_distance, squared_residual };
        let (rate, pyramid) = self.affine.witness(near, radius, model)?;
        Some(PairWitness::Affine { gradient: self.affine.gradient().to_vec(), dir, rate, pyramid })
    }
}
