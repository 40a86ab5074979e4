//! The model in scaled coordinates `z = S (q - centre)`: positions at the centre, scaled modes `A = U S^-1`, and the
//! rounding bound of its positions (paper, section 6).

use glam::DVec3;

use super::metric::Metric;
use super::mode_rows::padded_rank;
use super::reduced_model::ReducedModel;
use super::required_gap::RequiredGap;
use super::rounding::{ROUND_UP, norm_up};
use super::rounding_bound::{LeastGap, RoundingBound};

/// Positions at the centre (called rest in the bounds) and scaled modes of a model, laid out for the bounds.
pub(crate) struct ScaledModel {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) faces: Vec<[u32; 3]>,
    /// The length of a row of modes: the rank, padded to whole lanes.
    pub(crate) row_len: usize,
    /// For each vertex three rows (x, y, z).
    modes: Vec<f64>,
    pub(crate) rounding: RoundingBound,
    /// The gap that a clearance needs in addition to the rounding bound; 0 without a clearance.
    pub(crate) required: RequiredGap,
    /// The largest length of a row of scaled modes.
    mode_reach: f64,
}

impl ScaledModel {
    /// Scales a model about the configuration `center`, from which z and radii are measured.
    pub(crate) fn new(model: &ReducedModel, metric: &Metric, center: &[f64]) -> Self {
        let mesh = model.mesh();
        let rank = model.rank();
        let positions: Vec<DVec3> =
            (0..mesh.rest_positions().len() as u32).map(|i| model.position(i, center)).collect();
        let row_len = padded_rank(rank);
        let mut modes = vec![0.0; positions.len() * 3 * row_len];
        let mut rest_reach = DVec3::ZERO;
        let mut mode_reach = DVec3::ZERO;
        let (mut scaled, mut magnitudes) = (vec![DVec3::ZERO; rank], vec![DVec3::ZERO; rank]);
        for i in mesh.used_vertices() {
            let rows = &mut modes[i as usize * 3 * row_len..][..3 * row_len];
            let of_vertex = model.modes().of_vertex(i);
            metric.scaled_modes(of_vertex, &mut scaled);
            for (k, a) in scaled.iter().enumerate() {
                [rows[k], rows[row_len + k], rows[2 * row_len + k]] = a.to_array();
            }
            // The sums that lead to the positions at the centre are rounded, too.
            let moved: DVec3 = of_vertex.iter().zip(center).map(|(u, q)| (*u * *q).abs()).sum();
            let at_rest = mesh.rest_positions()[i as usize].abs();
            rest_reach = rest_reach.max(at_rest + with_mutant!(moved, RestErrorWithoutCenter, DVec3::ZERO));
            metric.magnitudes(&scaled, &mut magnitudes);
            let norm = |axis: usize| norm_up(magnitudes.iter().map(|m| m[axis] * m[axis]).sum(), row_len);
            mode_reach = mode_reach.max(DVec3::new(norm(0), norm(1), norm(2)));
        }
        // A component without displacements still needs a positive rounding bound if others have displacements: squares of
        // numbers below 2^-537 underflow, and the largest mode is above 2^-200.
        let floor = with_mutant!(mode_reach.max_element() * f64::EPSILON, ModeReachWithoutFloor, 0.0);
        let mode_reach = mode_reach.max(DVec3::splat(floor));
        let rounding = RoundingBound::new(rest_reach, mode_reach, model.rank());
        let required = RequiredGap::default();
        let mode_reach = mode_reach.max_element();
        Self { positions, faces: mesh.faces().to_vec(), row_len, modes, rounding, required, mode_reach }
    }

    /// Returns the same model, whose parts must keep a clearance. `error`: the error of computed distances, as a share
    /// of the size of two triangles together.
    pub(crate) fn keeping(mut self, clearance: f64, error: f64) -> Self {
        let (mut lower, mut upper) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for i in self.faces.as_flattened() {
            let x = self.positions[*i as usize];
            (lower, upper) = (lower.min(x), upper.max(x));
        }
        let extent = (upper - lower).max_element().max(0.0) * ROUND_UP;
        self.required = RequiredGap::new(clearance, extent, self.mode_reach, error);
        self
    }

    /// Returns the gap along a direction that proves two points separate, by more than the clearance if there is one.
    #[inline]
    pub(crate) fn least_gap(&self, dir: DVec3) -> LeastGap {
        let required = with_mutant!(self.required.along(dir), DirectionWithoutClearance, LeastGap::default());
        self.rounding.along(dir).plus(required)
    }

    /// Returns the modes of a vertex: three rows.
    #[inline]
    pub(crate) fn modes(&self, vertex: u32) -> &[f64] {
        let width = 3 * self.row_len;
        &self.modes[vertex as usize * width..][..width]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Modes, TriMesh};

    fn is_near(found: f64, wanted: f64) -> bool {
        wanted <= found && found <= wanted * (1.0 + 1e-12)
    }

    fn gamma(rank: usize) -> f64 {
        let n = (2 * rank + 96) as f64 * (f64::EPSILON / 2.0);
        n / (1.0 - n)
    }

    #[test]
    fn rounding_bounds_have_twice_the_roundings_of_two_positions() {
        for rank in [1, 7, 1000, 1 << 20] {
            let bound = RoundingBound::new(DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0), rank);
            let both = bound.between_configurations(10.0);
            for (axis, dir) in [DVec3::X, DVec3::NEG_Y, DVec3::Z].into_iter().enumerate() {
                let [rest, modes] = [1.0, 4.0].map(|first| (first + axis as f64) * 2.0 * gamma(rank));
                assert!(is_near(bound.at_rest(dir), rest) && is_near(bound.per_norm(dir), modes), "{rank}");
                assert!(is_near(both.at_rest(dir), 4.0 * (rest + 10.0 * modes)), "{rank}");
                assert_eq!(both.per_norm(dir), bound.per_norm(dir));
            }
            // Underflow: four times the smallest number for each rounding, and the smallest normal number.
            let least = f64::MIN_POSITIVE + (4 * (rank + 96)) as f64 * f64::from_bits(1);
            let nothing = RoundingBound::new(DVec3::ZERO, DVec3::ZERO, rank).at_rest(DVec3::X);
            assert!(is_near(nothing, least), "{rank}: {nothing:e}");
        }
    }

    #[test]
    fn reaches_are_those_of_sums_at_the_centre_and_of_rows_of_modes() {
        let away = DVec3::new(0.0, 0.0, 900.0);
        let mesh = TriMesh::new(vec![DVec3::new(1.0, -2.0, 4.0), away, away], vec![[0, 1, 2]]).unwrap();
        let mut modes = vec![DVec3::ZERO; 6];
        (modes[0], modes[1]) = (DVec3::new(3.0, 0.0, 100.0), DVec3::new(4.0, -10.0, 0.0));
        let metric = Metric::identity(2);
        let model = ReducedModel::with_metric(mesh, Modes::new(2, modes).unwrap(), metric.clone()).unwrap();
        let scaled = ScaledModel::new(&model, &metric, &[10.0, -20.0]);
        // The first vertex is at (-49, 198, 1004), by sums of (1, 2, 4), (30, 0, 1000) and (80, 200, 0).
        let dirs = [DVec3::X, DVec3::Y, DVec3::Z];
        for (dir, (rest, modes)) in dirs.into_iter().zip([(111.0, 5.0), (202.0, 10.0), (1004.0, 100.0)]) {
            assert!(is_near(scaled.rounding.at_rest(dir), rest * 2.0 * gamma(2)), "{dir}");
            assert!(is_near(scaled.rounding.per_norm(dir), modes * 2.0 * gamma(2)), "{dir}");
        }
        // The extents are 49, 198 and 104; twice the error counts.
        assert!(is_near(scaled.keeping(1.0, 0.5).required.at_rest(), 199.0));
    }
}
