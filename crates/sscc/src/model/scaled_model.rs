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
