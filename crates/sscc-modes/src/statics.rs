//! Coordinates q of a load, and of given displacements.

use faer::{Mat, MatRef};
use glam::DVec3;
use sscc::Modes;
use sscc_solid::Stiffness;

use crate::ModesError;
use crate::eigen::dense::symmetric_eigen;
use crate::eigen::tall_matrix::{add_product, inner, product};

/// Maximum eigenvalue of a stiffness, relative to the largest, that counts as 0, and maximum share of a load in such
/// directions.
const ZERO_STIFFNESS: f64 = 1e-12;

/// Maximum eigenvalue of `U'U`, relative to the largest, of directions that are omitted from a fit, because they may be rounding.
const DEPENDENT: f64 = 1e-12;

/// Number of corrections of a fit by its own residual, which bring it to rounding.
const CORRECTIONS: usize = 2;

/// Returns the generalized forces `U'f` (r) of forces on single vertices. Forces on one vertex are added.
///
/// # Errors
/// When a vertex does not exist.
pub fn generalized_forces(modes: &Modes, forces: &[(u32, DVec3)]) -> Result<Vec<f64>, ModesError> {
    let vertices = modes.vertices();
    let mut sum = vec![0.0; modes.rank()];
    for (vertex, force) in forces {
        if *vertex as usize >= vertices {
            return Err(ModesError::LoadedVertex { vertex: *vertex, vertices });
        }
        sum.iter_mut().zip(modes.of_vertex(*vertex)).for_each(|(sum, u)| *sum += u.dot(*force));
    }
    Ok(sum)
}

/// Returns the linear static answer to generalized forces in the span of the modes: the q with `K q = U'f`, where K is
/// the symmetric part of the stiffness. For a diagonal stiffness `q_i = u_i.f / lambda_i`.
///
/// # Errors
/// When there is not one force for each mode, an eigenvalue is negative, the load acts along a direction without stiffness, or
/// the norm of the forces or an entry of q is not finite.
pub fn static_configuration(stiffness: &Stiffness, forces: &[f64]) -> Result<Vec<f64>, ModesError> {
    let rank = stiffness.rank();
    if forces.len() != rank {
        return Err(ModesError::StiffnessRank { found: rank, rank: forces.len() });
    }
    let entries = stiffness.symmetrised();
    let matrix = Mat::from_fn(rank, rank, |i, j| entries[i * rank + j]);
    let (values, vectors) = symmetric_eigen(matrix.as_ref())?;
    let largest = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = forces.iter().map(|f| f * f).sum::<f64>().sqrt();
    // If the norm is not finite, shares of the load are not defined.
    if !size.is_finite() {
        return Err(ModesError::OutOfRange);
    }
    let mut q = vec![0.0; rank];
    for (k, value) in values.iter().enumerate() {
        let along: f64 = (0..rank).map(|i| vectors[(i, k)] * forces[i]).sum();
        if *value < -ZERO_STIFFNESS * largest {
            return Err(ModesError::StiffnessIndefinite { eigenvalue: *value, largest });
        }
        if *value > ZERO_STIFFNESS * largest {
            q.iter_mut().enumerate().for_each(|(i, q)| *q += vectors[(i, k)] * along / value);
        } else if along.abs() > ZERO_STIFFNESS * size {
            return Err(ModesError::NoStaticAnswer);
        }
    }
    if q.iter().all(|q| q.is_finite()) { Ok(q) } else { Err(ModesError::OutOfRange) }
}

/// Least-squares fit of q to displacements of all vertices.
pub struct DisplacementFit {
    /// The modes, each divided by its norm, so that their units do not matter.
    modes: Mat<f64>,
    /// The norm of each mode; 1 where it moves nothing.
    norms: Vec<f64>,
    /// The pseudo-inverse of `U'U`.
    inverse: Mat<f64>,
}

/// The q whose displacements are nearest to given ones.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedConfiguration {
    /// The q; if several are equally near, that of the smallest norm, with each mode in units of its own norm.
    pub q: Vec<f64>,
    /// Norm of the residual over that of the displacements; 0 without displacements.
    pub residual: f64,
    /// The largest distance of a vertex from its given position (model unit).
    pub largest: f64,
    /// The vertex at that distance.
    pub vertex: u32,
}

impl DisplacementFit {
    /// Prepares fits for these modes, which may be linearly dependent: with each mode divided by its norm, directions
    /// whose singular value is at most 1e-6 of the largest one are omitted.
    ///
    /// # Errors
    /// When the norm of a mode is not finite.
    pub fn new(modes: &Modes) -> Result<Self, ModesError> {
        let rank = modes.rank();
        let entry = |row: usize, k: usize| modes.displacements()[row / 3 * rank + k][row % 3];
        let rows = 3 * modes.vertices();
        let norm = |k: usize| (0..rows).map(|row| entry(row, k).powi(2)).sum::<f64>().sqrt();
        let norms: Vec<f64> = (0..rank).map(norm).map(|norm| if norm > 0.0 { norm } else { 1.0 }).collect();
        if norms.iter().any(|norm| !norm.is_finite()) {
            return Err(ModesError::OutOfRange);
        }
        let modes = Mat::from_fn(rows, rank, |row, k| entry(row, k) / norms[k]);
        let (values, vectors) = symmetric_eigen(inner(modes.as_ref(), modes.as_ref()).as_ref())?;
        let largest = values.last().copied().unwrap_or_default();
        let kept: Vec<usize> = (0..rank).filter(|k| values[*k] > DEPENDENT * largest).collect();
        let term = |i: usize, j: usize, k: usize| vectors[(i, k)] * vectors[(j, k)] / values[k];
        let inverse = Mat::from_fn(rank, rank, |i, j| kept.iter().map(|k| term(i, j, *k)).sum());
        Ok(Self { modes, norms, inverse })
    }

    /// Fits q to one displacement for each vertex.
    ///
    /// # Errors
    /// When the number of displacements is not that of vertices, or the result is not finite.
    pub fn fit(&self, displacements: &[DVec3]) -> Result<FittedConfiguration, ModesError> {
        let (modes, vertices) = (self.modes.as_ref(), self.modes.nrows() / 3);
        if displacements.len() != vertices {
            return Err(sscc::Error::VertexCount { modes: vertices, mesh: displacements.len() }.into());
        }
        let given = Mat::from_fn(3 * vertices, 1, |row, _| displacements[row / 3][row % 3]);
        let mut q = Mat::<f64>::zeros(modes.ncols(), 1);
        let mut left = given.clone();
        for _ in 0..=CORRECTIONS {
            q += product(self.inverse.as_ref(), inner(modes, left.as_ref()).as_ref());
            left.copy_from(&given);
            add_product(left.as_mut(), modes, q.as_ref(), -1.0);
        }
        let q: Vec<f64> = self.norms.iter().enumerate().map(|(k, norm)| q[(k, 0)] / norm).collect();
        let size = norm(given.as_ref());
        let residual = if size > 0.0 { norm(left.as_ref()) / size } else { 0.0 };
        if !(residual.is_finite() && q.iter().all(|q| q.is_finite())) {
            return Err(ModesError::OutOfRange);
        }
        let distance =
            |v: u32| DVec3::from_array([0, 1, 2].map(|axis| left[(3 * v as usize + axis, 0)])).length();
        let farther =
            |found: (f64, u32), v: u32| if distance(v) > found.0 { (distance(v), v) } else { found };
        let (largest, vertex) = (0..vertices as u32).fold((0.0, 0), farther);
        Ok(FittedConfiguration { q, residual, largest, vertex })
    }
}

fn norm(column: MatRef<f64>) -> f64 {
    (0..column.nrows()).map(|row| column[(row, 0)] * column[(row, 0)]).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_has_the_answer_of_the_stiffness() {
        let stiffness = Stiffness::new(2, vec![2.0, -1.0, -1.0, 2.0]).unwrap();
        let q = static_configuration(&stiffness, &[3.0, 0.0]).unwrap();
        assert!((q[0] - 2.0).abs() < 1e-14 && (q[1] - 1.0).abs() < 1e-14, "{q:?}");
        let diagonal = |values: &[f64]| Stiffness::from_diagonal(values).unwrap();
        assert_eq!(static_configuration(&diagonal(&[4.0, 2.0]), &[1.0, 1.0]).unwrap(), [0.25, 0.5]);
        assert_eq!(static_configuration(&diagonal(&[0.0, 2.0]), &[0.0, 1.0]).unwrap(), [0.0, 0.5]);
        assert_eq!(
            static_configuration(&diagonal(&[0.0, 2.0]), &[1.0, 1.0]),
            Err(ModesError::NoStaticAnswer)
        );
        // The norm of the load is not finite.
        assert_eq!(static_configuration(&diagonal(&[0.0, 2.0]), &[1e200, 1.0]), Err(ModesError::OutOfRange));
        assert!(static_configuration(&diagonal(&[-1.0, 2.0]), &[1.0, 1.0]).is_err());
        assert!(static_configuration(&diagonal(&[1.0, 2.0]), &[1.0]).is_err());
        let modes = Modes::from_matrix(2, 2, |row, k| (2 * row + k) as f64).unwrap();
        let forces = [(1, DVec3::X), (1, DVec3::Y), (0, DVec3::Z)];
        assert_eq!(generalized_forces(&modes, &forces).unwrap(), [6.0 + 8.0 + 4.0, 7.0 + 9.0 + 5.0]);
        let missing = ModesError::LoadedVertex { vertex: 2, vertices: 2 };
        assert_eq!(generalized_forces(&modes, &[(2, DVec3::X)]), Err(missing));
    }

    #[test]
    fn fits_reproduce_displacements_and_state_the_residual() {
        let modes =
            Modes::from_matrix(4, 3, |row, k| ((row * row + 3 * k * row + k) % 7) as f64 - 3.0).unwrap();
        let fit = DisplacementFit::new(&modes).unwrap();
        let q = [0.5, -2.0, 1.0];
        let of = |v: u32| modes.of_vertex(v).iter().zip(q).map(|(u, q)| *u * q).sum::<DVec3>();
        let moved: Vec<DVec3> = (0..4).map(of).collect();
        let found = fit.fit(&moved).unwrap();
        assert!(found.q.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
        assert!(found.residual < 1e-14 && found.largest < 1e-13);
        assert_eq!(fit.fit(&[DVec3::ZERO; 4]).unwrap().residual, 0.0);
        assert!(fit.fit(&moved[1..]).is_err());
    }

    #[test]
    fn units_of_modes_do_not_matter() {
        let entry = |row: usize, k: usize| ((row * row + 3 * k * row + k) % 7) as f64 - 3.0;
        for small in [1e-7, 1e-12, 1e12] {
            let scale = |k: usize| if k == 2 { small } else { 1.0 };
            let modes = Modes::from_matrix(4, 3, |row, k| entry(row, k) * scale(k)).unwrap();
            let q = [0.5, -2.0, 1.0 / small];
            let of = |v: u32| modes.of_vertex(v).iter().zip(q).map(|(u, q)| *u * q).sum::<DVec3>();
            let moved: Vec<DVec3> = (0..4).map(of).collect();
            let found = DisplacementFit::new(&modes).unwrap().fit(&moved).unwrap();
            assert!(
                found.q.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-12 * b.abs()),
                "{small}: {found:?}"
            );
            assert!(found.residual < 1e-13, "{small}: {found:?}");
        }
    }

    #[test]
    fn dependent_modes_give_the_answer_of_the_smallest_norm() {
        // Two equal modes and one that moves nothing; the second vertex is not reached by any.
        let modes = Modes::from_matrix(2, 3, |row, k| if row == 0 && k < 2 { 1.0 } else { 0.0 }).unwrap();
        let found = DisplacementFit::new(&modes).unwrap().fit(&[4.0 * DVec3::X, 3.0 * DVec3::Y]).unwrap();
        assert!((found.q[0] - 2.0).abs() < 1e-14 && (found.q[1] - 2.0).abs() < 1e-14 && found.q[2] == 0.0);
        assert!((found.residual - 0.6).abs() < 1e-14 && (found.largest, found.vertex) == (3.0, 1));
        let still = Modes::from_matrix(2, 1, |_, _| 0.0).unwrap();
        assert_eq!(DisplacementFit::new(&still).unwrap().fit(&[DVec3::X; 2]).unwrap().q, [0.0]);
    }
}
