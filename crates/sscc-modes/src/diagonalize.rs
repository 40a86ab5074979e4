//! Rotation of modes that makes the stiffness diagonal (paper, section 6).

use faer::Mat;
use glam::DVec3;
use sscc::Modes;
use sscc_solid::Stiffness;

use crate::ModesError;
use crate::eigen::dense::symmetric_eigen;
use crate::eigen::fix_signs;

/// Maximum eigenvalue, relative to the largest, that counts as 0. Rounding gives rigid motions about 1e-14, of either
/// sign, which must not become the smallest positive weight.
const ZERO_TOLERANCE: f64 = 1e-12;

/// Modes with a diagonal stiffness: see [`diagonalize`].
#[derive(Clone, Debug, PartialEq)]
pub struct DiagonalModes {
    /// `U' = U Q` (3V x r).
    pub modes: Modes,
    /// The diagonal of `Lambda`, one for each mode (energy per q squared), ascending, none negative.
    pub eigenvalues: Vec<f64>,
    /// The orthogonal matrix `Q` (r x r, row-major): `q = Q q'`, `q' = Q'q`. Column k is mode k of `U'`
    /// in terms of the modes of `U`.
    pub rotation: Vec<f64>,
}

/// Rotates modes so that a stiffness becomes diagonal: `K~ = Q Lambda Q'`, `U' = U Q`. The new modes span the same
/// shapes: `p + U q = p + U' q'` for `q = Q q'`, up to rounding. Certificates of a model with the new modes hold
/// exactly for its own positions.
///
/// `stiffness` is the reduced stiffness matrix `K~ = U'KU` at q = 0 (energy per q squared), for example from
/// [`reduced_stiffness`](crate::reduced_stiffness). In the new modes the elastic energy is a sum over single modes, so a
/// diagonal metric can measure it: see [`energy_metric`](crate::energy_metric).
///
/// The signs are unique: the largest component of each column of `Q` is positive, the first one of equals. Equal
/// eigenvalues permit any orthonormal basis of their space. The same input gives the same bits on one processor; other
/// processors may round differently.
///
/// Eigenvalues of at most 1e-12 of the largest become 0. The result depends on the lengths of the modes, so they should
/// be similar; mass-orthonormal modes are best, with squared natural angular frequencies in `Lambda`.
///
/// ```
/// use glam::DVec3;
/// use sscc::{Modes, ReducedModel, TriMesh};
/// use sscc_modes::{DEFAULT_ELL, diagonalize, energy_metric, filter_eigenvalues};
/// use sscc_solid::Stiffness;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // Two triangles, and two modes that move the second along z and x.
/// let positions = vec![
///     DVec3::ZERO, DVec3::X, DVec3::Y,
///     DVec3::Z, DVec3::X + DVec3::Z, DVec3::Y + DVec3::Z,
/// ];
/// let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]])?;
/// let modes = Modes::from_matrix(6, 2, |row, mode| {
///     if row >= 9 && row % 3 == [2, 0][mode] { 1.0 } else { 0.0 }
/// })?;
/// let stiffness = Stiffness::new(2, vec![2.0, -1.0, -1.0, 2.0])?;
///
/// let diagonal = diagonalize(&modes, &stiffness)?;
/// assert!((diagonal.eigenvalues[0] - 1.0).abs() < 1e-12); // x and z together
/// assert!((diagonal.eigenvalues[1] - 3.0).abs() < 1e-12); // x against z
///
/// let weights = filter_eigenvalues(&diagonal.eigenvalues, DEFAULT_ELL)?;
/// let model = ReducedModel::with_metric(mesh, diagonal.modes, energy_metric(&weights)?)?;
/// # assert_eq!(model.rank(), 2);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// When the stiffness has another rank or an eigenvalue below -1e-12 of the largest, the eigenvalues do not converge,
/// or an entry of the new modes is out of range.
pub fn diagonalize(modes: &Modes, stiffness: &Stiffness) -> Result<DiagonalModes, ModesError> {
    let rank = modes.rank();
    if stiffness.rank() != rank {
        return Err(ModesError::StiffnessRank { found: stiffness.rank(), rank });
    }
    let (mut eigenvalues, rotation) = eigen(rank, &stiffness.symmetrised())?;
    let largest = eigenvalues.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for x in &mut eigenvalues {
        if *x < -ZERO_TOLERANCE * largest {
            return Err(ModesError::StiffnessIndefinite { eigenvalue: *x, largest });
        }
        if *x <= ZERO_TOLERANCE * largest {
            *x = 0.0;
        }
    }
    let mut displacements = vec![DVec3::ZERO; modes.displacements().len()];
    for (new, old) in displacements.chunks_exact_mut(rank).zip(modes.displacements().chunks_exact(rank)) {
        for (u, row) in old.iter().zip(rotation.chunks_exact(rank)) {
            new.iter_mut().zip(row).for_each(|(sum, x)| *sum += *u * *x);
        }
    }
    Ok(DiagonalModes { modes: Modes::new(rank, displacements)?, eigenvalues, rotation })
}

/// Returns the eigenvalues of a stiffness, ascending. For mass-orthonormal modes they are squared natural angular
/// frequencies. Zeros may become about 1e-14 of the largest, of either sign, by rounding.
///
/// # Errors
/// When the eigenvalues do not converge.
pub fn stiffness_eigenvalues(stiffness: &Stiffness) -> Result<Vec<f64>, ModesError> {
    Ok(eigen(stiffness.rank(), &stiffness.symmetrised())?.0)
}

/// Returns ascending eigenvalues and orthonormal eigenvectors (the columns of a row-major matrix) of a symmetric
/// matrix, the largest component of each positive.
fn eigen(rank: usize, matrix: &[f64]) -> Result<(Vec<f64>, Vec<f64>), ModesError> {
    let matrix = Mat::from_fn(rank, rank, |i, j| matrix[i * rank + j]);
    let (values, mut vectors) = symmetric_eigen(matrix.as_ref())?;
    fix_signs(&mut vectors);
    let vectors = (0..rank * rank).map(|at| vectors[(at / rank, at % rank)]).collect();
    Ok((values, vectors))
}
