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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::tests::random::Random;
    use crate::model::ScaledModel;
    use crate::{Metric, Modes, ReducedModel, TriMesh};

    /// A corner: its position, and its displacements by three modes.
    type Corner = [DVec3; 4];

    const FACES: [[u32; 3]; 2] = [[0, 1, 2], [3, 4, 5]];

    /// Returns two triangles in scaled coordinates.
    fn scaled_model(corners: &[[Corner; 3]; 2]) -> ScaledModel {
        let corners = corners.as_flattened();
        let mesh = TriMesh::new(corners.iter().map(|c| c[0]).collect(), FACES.to_vec()).unwrap();
        let modes = Modes::new(3, corners.iter().flat_map(|c| c[1..].to_vec()).collect()).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(3)).unwrap();
        ScaledModel::new(&model, model.metric(), &[0.0; 3])
    }

    fn target(cap: f64, subdivisions: usize) -> RefinementTarget {
        RefinementTarget { cap, upper: f64::INFINITY, epsilon: 0.05, subdivisions }
    }

    /// Checks a list as another program would: parts in their order, with the corners that the quarters have.
    /// It believes the rates of affine maps.
    struct Checker<'w> {
        witnesses: std::slice::Iter<'w, PairWitness>,
        directions: Vec<DVec3>,
        radius: f64,
    }

    impl Checker<'_> {
        /// Whether the next witnesses prove two triangles apart.
        fn proves(&mut self, triangles: [[Corner; 3]; 2]) -> bool {
            let pairs = || (0..9).map(move |ij| (triangles[0][ij / 3], triangles[1][ij % 3]));
            let dir = match self.witnesses.next().unwrap() {
                PairWitness::Known(number) => self.directions[*number],
                PairWitness::Direction(dir) => {
                    self.directions.push(*dir);
                    *dir
                }
                PairWitness::Quarters { is_first } => {
                    let side = usize::from(!is_first);
                    let [p, q, r] = triangles[side];
                    let middle =
                        |x: Corner, y: Corner| -> Corner { std::array::from_fn(|i| (x[i] + y[i]) * 0.5) };
                    let (pq, qr, rp) = (middle(p, q), middle(q, r), middle(r, p));
                    return [[p, pq, rp], [pq, q, qr], [rp, qr, r], [pq, qr, rp]].into_iter().all(|part| {
                        let mut parts = triangles;
                        parts[side] = part;
                        self.proves(parts)
                    });
                }
                PairWitness::Affine { gradient, dir, rate, .. } => {
                    let row_len = gradient.len() / 9;
                    let gap = pairs().map(|(x, y)| dir.dot(y[0] - x[0])).fold(f64::INFINITY, f64::min);
                    let delta = gap / dir.length();
                    let residual = |x: Corner, y: Corner| -> f64 {
                        let left = |k: usize, c: usize| -> f64 {
                            let fitted: f64 =
                                (0..3).map(|j| gradient[(3 * c + j) * row_len + k] * (y[0] - x[0])[j]).sum();
                            (y[1 + k] - x[1 + k])[c] - fitted
                        };
                        (0..9).map(|at| left(at / 3, at % 3).powi(2)).sum::<f64>().sqrt()
                    };
                    let largest = pairs().map(|(x, y)| residual(x, y)).fold(0.0, f64::max);
                    return delta >= self.radius * (rate * delta + largest);
                }
            };
            pairs().all(|(x, y)| {
                let [gap, u, v, w] = std::array::from_fn(|i| dir.dot(y[i] - x[i]));
                gap >= self.radius * DVec3::new(u, v, w).length()
            })
        }
    }

    /// Whether a list proves two triangles apart, and has no more witnesses.
    fn is_proven(list: &WitnessList, triangles: [[Corner; 3]; 2], radius: f64) -> bool {
        let mut checker = Checker { witnesses: list.witnesses.iter(), directions: Vec::new(), radius };
        checker.proves(triangles) && checker.witnesses.next().is_none()
    }

    /// Two small triangles, of which one corner moves along x and another along z only: a single direction
    /// proves 6, while their points meet at nearly `6 sqrt 2`. Parts have directions of their own.
    #[test]
    fn divided_triangles_have_a_witness_for_each_part() {
        let small = [DVec3::ZERO, DVec3::X * 0.01, DVec3::Y * 0.01];
        let apart = DVec3::new(3.0, 0.0, 3.0);
        let still = small.map(|p| [p, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO]);
        let moving = [
            [small[0] + apart, DVec3::X, DVec3::ZERO, DVec3::Y],
            [small[1] + apart, DVec3::ZERO, DVec3::Z, DVec3::Y],
            [small[2] + apart, DVec3::ZERO, DVec3::ZERO, DVec3::Y],
        ];
        let scaled = scaled_model(&[still, moving]);
        for (triangles, [a, b]) in [([still, moving], FACES), ([moving, still], [FACES[1], FACES[0]])] {
            let mut refiner = PairRefiner::new(&scaled);
            let whole = refiner.bound(a, b, &mut target(f64::INFINITY, 0));
            let radius = 0.98 * refiner.refine(a, b, &mut target(f64::INFINITY, 500));
            assert!(radius > 1.2 * whole && radius < 72.0_f64.sqrt(), "{whole} {radius}");
            let mut list = WitnessList::default();
            assert!(refiner.prove(a, b, radius, &mut list));
            assert!(matches!(list.witnesses[0], PairWitness::Quarters { .. }), "{list:?}");
            assert!(is_proven(&list, triangles, radius), "{list:?}");
        }
    }

    /// Two triangles of a plane turn about all axes, with a little noise. Up to their bound they have
    /// witnesses, of which the affine ones hold for the residuals of all pairs of corners.
    #[test]
    fn affine_witnesses_hold_for_all_corners() {
        let plane = [[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[2.0, 0.0], [3.0, 0.0], [2.0, 1.0]]];
        let mut affine = 0;
        for case in 0..40 {
            let random = &mut Random::new(case);
            let triangles = plane.map(|triangle| {
                triangle.map(|[x, y]| -> Corner {
                    let p = DVec3::new(x, y, 0.0) + random.vector() * 0.02;
                    let [u, v, w] = DVec3::AXES.map(|axis| axis.cross(p) + random.vector() * 1e-3);
                    [p, u, v, w]
                })
            });
            let scaled = scaled_model(&triangles);
            let mut refiner = PairRefiner::new(&scaled);
            let [a, b] = FACES;
            let mut radius = 10.0;
            while refiner.bound(a, b, &mut target(radius, 0)) >= radius {
                let mut list = WitnessList::default();
                assert!(refiner.prove(a, b, radius, &mut list), "case {case}: {radius}");
                assert!(is_proven(&list, triangles, radius), "case {case}: {radius}");
                affine += usize::from(matches!(list.witnesses[..], [PairWitness::Affine { .. }]));
                radius *= 1.1;
            }
        }
        assert!(affine > 100, "{affine}");
    }

    /// A direction is known where it separates the triangles, and only there.
    #[test]
    fn known_directions_are_those_that_separate() {
        let [x, y, z] = DVec3::AXES;
        let low = [DVec3::ZERO, x, y].map(|p| [p, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO]);
        let scaled = scaled_model(&[low, [DVec3::ZERO, x, y].map(|p| [p + z, x, y, z])]);
        let mut refiner = PairRefiner::new(&scaled);
        let mut list = WitnessList::default();
        let [a, b] = FACES;
        for (x, y) in [(a, b), (a, b), (b, a), (b, a), (a, b)] {
            assert!(refiner.prove(x, y, 0.9, &mut list));
        }
        let [PairWitness::Direction(up), known @ ..] = &list.witnesses[..] else { panic!("{list:?}") };
        let [PairWitness::Known(0), PairWitness::Direction(down), known @ ..] = known else {
            panic!("{list:?}")
        };
        assert!((*up - z).length() < 1e-9 && (*down + z).length() < 1e-9, "{up} {down}");
        assert!(matches!(known, [PairWitness::Known(1), PairWitness::Known(0)]), "{list:?}");
        assert!(!refiner.prove(a, b, 1.0, &mut list));
    }
}
