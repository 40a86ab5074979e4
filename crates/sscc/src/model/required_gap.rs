//! The gap that parts must keep if certificates have a clearance: in addition to the rounding bound, the clearance itself and
//! the error of the distances that queries report.
//!
//! Two sets of points are farther apart than D if along some direction dir every gap of two of their points exceeds
//! `D |dir|`, because a gap along dir is at most |dir| times the distance. So each bound of `|z|` subtracts `D |dir|`, in
//! addition to the rounding bound, from the gap of computed positions, and is a bound of the `|z|` at which the distance of two
//! parts is D. Scaled directions ([`scale_direction`](super::scale_direction)) are not unit vectors: without |dir| a radius
//! would be too large by up to the root of 3.
//!
//! A query compares a clearance d with computed distances, which may be too small by a share of the size of both triangles. This
//! size is the largest difference of two of their coordinates along an axis. At z it is at most the extent of the model at the
//! centre, plus twice the largest length of a row of scaled modes times |z|. So `D = d + share (extent + 2 reach |z|)`: a part at
//! rest, and a part per unit of |z|.

use glam::DVec3;

use super::rounding::ROUND_UP;
use super::rounding_bound::LeastGap;

/// The gap along any direction by which parts keep a clearance; 0 without one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RequiredGap {
    /// The part that does not depend on z, per unit of a direction's length.
    at_rest: f64,
    /// The part per unit of `|z|` and of a direction's length.
    per_norm: f64,
}

impl RequiredGap {
    /// Computes the gap of a clearance. `extent`: the largest extent of the model at the centre along an axis. `mode_reach`: the
    /// largest length of a row of scaled modes. `error`: the error of computed distances, as a share of the size of both triangles.
    pub(super) fn new(clearance: f64, extent: f64, mode_reach: f64, error: f64) -> Self {
        // Twice the error covers the rounding of the extent, of the reach and of positions, which is far smaller.
        let (error, reach) = (2.0 * error * ROUND_UP, 2.0 * mode_reach);
        Self {
            at_rest: (clearance + with_mutant!(error * extent, DistanceErrorAtRestForgotten, 0.0)) * ROUND_UP,
            per_norm: with_mutant!(error * reach, DistanceErrorOfMotionForgotten, 0.0),
        }
    }

    /// Returns the part that does not depend on z, for a direction of length 1.
    pub(crate) fn at_rest(&self) -> f64 {
        self.at_rest
    }

    /// Returns both parts for a direction of length 1.
    pub(crate) fn along_unit(&self) -> LeastGap {
        LeastGap { at_rest: self.at_rest, per_norm: self.per_norm }
    }

    /// Returns both parts along a direction, rounded up.
    #[inline]
    pub(crate) fn along(&self, dir: DVec3) -> LeastGap {
        let length = with_mutant!(dir.length() * ROUND_UP, RequiredGapOfUnitDirections, 1.0);
        LeastGap { at_rest: self.at_rest * length, per_norm: self.per_norm * length }
    }
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;

    /// Both parts are at least the exact sums of the clearance and of the error of distances, along any direction.
    #[test]
    fn gaps_hold_the_clearance_and_the_error_of_distances() {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        for (clearance, extent, reach) in
            [(0.1, 3.0, 7.0), (1e-9, 1.0, 0.3), (1e-30, 1e3, 1e-5), (7.0, 1e-4, 1e9)]
        {
            let error = 1.0 / (1_u64 << 40) as f64;
            let gap = RequiredGap::new(clearance, extent, reach, error);
            let (at_rest, per_norm) =
                (exact(clearance) + exact(error) * exact(extent), exact(2.0 * error) * exact(reach));
            for dir in
                [DVec3::X, DVec3::new(1.0, -0.3, 0.7), DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1e-9, 1.0, 0.1)]
            {
                let square: BigRational = dir.to_array().map(|x| exact(x) * exact(x)).into_iter().sum();
                let along = gap.along(dir);
                for (found, wanted) in [(along.at_rest, &at_rest), (along.per_norm, &per_norm)] {
                    assert!(
                        exact(found) * exact(found) >= wanted * wanted * &square,
                        "{found:e} along {dir}"
                    );
                }
            }
            assert!(exact(gap.at_rest()) >= at_rest && exact(gap.along_unit().per_norm) >= per_norm);
            // The parts are not much larger.
            assert!(gap.at_rest() <= (clearance + 2.1 * error * extent) * (1.0 + 1e-12));
        }
        assert_eq!(RequiredGap::default().along(DVec3::ONE).at_rest, 0.0);
    }
}
