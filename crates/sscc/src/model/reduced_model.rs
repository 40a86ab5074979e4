//! A reduced deformable model `x = p + U q`: mesh, modes and a default metric.

use std::sync::Arc;

use glam::DVec3;

use crate::model::check_scaled_modes;
use crate::{Error, Metric, Modes, TriMesh, deformed_position, limits};

/// A reduced deformable model `x = p + U q`: a mesh, its modes, and the default metric of certificates. Clones share their data.
#[derive(Clone, Debug)]
pub struct ReducedModel(Arc<Contents>);

#[derive(Clone, Debug)]
struct Contents {
    mesh: TriMesh,
    modes: Modes,
    metric: Metric,
    /// The largest magnitude of a rest coordinate.
    rest_reach: f64,
    /// For each mode, the largest magnitude of an entry.
    mode_reach: Vec<f64>,
}

impl ReducedModel {
    /// Joins a mesh and its modes, with the displacement metric.
    ///
    /// # Errors
    /// When the modes are for another number of vertices, or out of the range in which the proofs hold.
    pub fn new(mesh: TriMesh, modes: Modes) -> Result<Self, Error> {
        let metric = Metric::displacement(&mesh, &modes)?;
        Self::with_metric(mesh, modes, metric)
    }

    /// Joins a mesh, its modes and a default metric.
    ///
    /// # Errors
    /// As [`ReducedModel::new`], and when the metric has another rank than the modes.
    pub fn with_metric(mesh: TriMesh, modes: Modes, metric: Metric) -> Result<Self, Error> {
        modes.check_mesh(&mesh)?;
        check_scaled_modes(&mesh, &modes, &metric)?;
        let rest_reach = mesh.rest_positions().iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
        let mut mode_reach = vec![0.0_f64; modes.rank()];
        for (index, u) in modes.displacements().iter().enumerate() {
            let reach = &mut mode_reach[index % modes.rank()];
            *reach = reach.max(u.abs().max_element());
        }
        Ok(Self(Arc::new(Contents { mesh, modes, metric, rest_reach, mode_reach })))
    }

    /// Returns the mesh at rest.
    pub fn mesh(&self) -> &TriMesh {
        &self.0.mesh
    }

    /// Returns the deformation modes.
    pub fn modes(&self) -> &Modes {
        &self.0.modes
    }

    /// Returns the default metric.
    pub fn metric(&self) -> &Metric {
        &self.0.metric
    }

    /// Returns the number of modes r.
    pub fn rank(&self) -> usize {
        self.0.modes.rank()
    }

    /// Returns the position of a vertex at `q` (model unit): see [`deformed_position`].
    ///
    /// # Panics
    /// When the mesh has no such vertex.
    pub fn position(&self, vertex: u32, q: &[f64]) -> DVec3 {
        deformed_position(self.0.mesh.rest_positions()[vertex as usize], self.0.modes.of_vertex(vertex), q)
    }

    /// Returns all deformed positions at `q` (V, model unit).
    ///
    /// # Errors
    /// As [`ReducedModel::check_coordinates`].
    pub fn positions(&self, q: &[f64]) -> Result<Vec<DVec3>, Error> {
        self.check_coordinates(q)?;
        Ok((0..self.0.mesh.rest_positions().len() as u32).map(|i| self.position(i, q)).collect())
    }

    /// Returns an upper bound (rounded to nearest) of every coordinate of `|p| + sum_k |U_k q_k|`.
    pub(crate) fn reach(&self, q: &[f64]) -> f64 {
        self.0.rest_reach + self.displacement_bound(q)
    }

    /// Returns an upper bound (rounded to nearest) of every coordinate of `sum_k |U_k q_k|`. It is not finite if an entry
    /// of q is not finite.
    #[inline]
    pub(crate) fn displacement_bound(&self, q: &[f64]) -> f64 {
        // There are four partial sums.
        let mut lanes = [0.0; 4];
        let (reaches, rest) = self.0.mode_reach.as_chunks::<4>();
        let (coordinates, last) = q.as_chunks::<4>();
        for (u, x) in reaches.iter().zip(coordinates) {
            for i in 0..4 {
                lanes[i] += u[i] * x[i].abs();
            }
        }
        let last: f64 = rest.iter().zip(last).map(|(u, x)| u * x.abs()).sum();
        (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]) + last
    }

    /// Returns an upper bound (rounded to nearest) of every coordinate of `|U_k q_k|`, for one mode k.
    pub(crate) fn mode_displacement_bound(&self, k: usize, q_k: f64) -> f64 {
        self.0.mode_reach[k] * q_k.abs()
    }

    /// Checks that q is a configuration of this model. Returns an upper bound (rounded to nearest) of every coordinate of
    /// `|p| + sum_k |U_k q_k|`; rounding bounds are multiples of it.
    ///
    /// # Errors
    /// When q has the wrong length, an entry is not finite, or the reach is beyond [`limits::LARGEST`].
    pub fn check_coordinates(&self, q: &[f64]) -> Result<f64, Error> {
        if q.len() != self.rank() {
            return Err(Error::CoordinatesLength { found: q.len(), rank: self.rank() });
        }
        let reach = self.reach(q);
        if !reach.is_finite() {
            let index = q.iter().position(|x| !x.is_finite());
            let not_finite = |index| Error::CoordinatesValue { index, value: q[index] };
            return Err(index.map_or(Error::CoordinatesRange, not_finite));
        }
        // Rounding may move a computed position beyond the exact reach.
        let rounding = 1.0 + (2 * q.len() + 8) as f64 * f64::EPSILON;
        if reach * rounding > limits::LARGEST {
            return Err(Error::CoordinatesRange);
        }
        Ok(reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_positions_and_modes_are_of_the_vertices() {
        let mesh = |last| TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, last]]);
        assert!(matches!(mesh(3), Err(Error::FaceIndex { vertex: 3, .. })));
        let mesh = mesh(2).unwrap();
        for count in 0..6 {
            assert_eq!(mesh.with_rest_positions(vec![DVec3::X; count]).is_ok(), count == 3, "{count}");
        }
        for vertices in [2, 4] {
            let modes = Modes::new(1, vec![DVec3::X; vertices]).unwrap();
            assert!(matches!(ReducedModel::new(mesh.clone(), modes), Err(Error::VertexCount { .. })));
        }
    }

    /// 2 r + 8 units in the last place remain for rounding.
    #[test]
    fn coordinates_end_before_rounding_leaves_the_range() {
        let mesh = TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, 2]]).unwrap();
        let modes = (0..15).map(|i| if i == 0 { DVec3::X } else { DVec3::ZERO }).collect();
        let modes = Modes::new(5, modes).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(5)).unwrap();
        let at = |units: f64| {
            let q = limits::LARGEST * (1.0 - units * f64::EPSILON);
            model.check_coordinates(&[q, 0.0, 0.0, 0.0, 0.0])
        };
        assert!(at(19.0).is_ok());
        for units in [17.0, 0.0, -1e9, -1e20] {
            assert_eq!(at(units), Err(Error::CoordinatesRange), "{units}");
        }
    }
}
