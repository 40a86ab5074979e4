//! Reduced stiffness matrices `K~ = U'KU` (paper, section 6).

use sscc::{Modes, limits};

use crate::ModesError;

/// A matrix is taken for symmetric when mirrored entries differ by at most this share of the largest
/// entry. Sums over millions of vertices, in any order, leave about 1e-11; mistakes leave far more.
const SYMMETRY_SHARE: f64 = 1e-9;

/// The reduced stiffness matrix `U'KU` (r x r, row-major, exactly symmetric) of a stiffness matrix `K`
/// (3V x 3V, force per length) that is given by what it does: `apply(u, force)` is handed a displacement
/// `u` (3V, vertex by vertex) and overwrites `force` (3V) with `K u`.
///
/// ```
/// use sscc::Modes;
/// use sscc_modes::reduced_stiffness;
///
/// // Two vertices, joined by a spring of stiffness 5 along x. They move as one, or apart.
/// let modes = Modes::from_matrix(2, 2, |row, mode| match (row, mode) {
///     (0, 0) | (3, 0) | (3, 1) => 1.0,
///     _ => 0.0,
/// })?;
/// let stiffness = reduced_stiffness(&modes, |u, force| {
///     force.fill(0.0);
///     force[0] = 5.0 * (u[0] - u[3]);
///     force[3] = -force[0];
/// })?;
/// assert_eq!(stiffness, [0.0, 0.0, 0.0, 5.0]);
/// # Ok::<(), sscc_modes::ModesError>(())
/// ```
///
/// # Errors
/// As [`diagonalize`](crate::diagonalize) for the entries and the symmetry of `U'KU`.
pub fn reduced_stiffness(
    modes: &Modes,
    mut apply: impl FnMut(&[f64], &mut [f64]),
) -> Result<Vec<f64>, ModesError> {
    let rank = modes.rank();
    let mut displacement = vec![0.0; 3 * modes.vertices()];
    let mut force = displacement.clone();
    let mut stiffness = vec![0.0; rank * rank];
    for column in 0..rank {
        for (x, u) in displacement.chunks_exact_mut(3).zip(modes.displacements().chunks_exact(rank)) {
            x.copy_from_slice(&u[column].to_array());
        }
        apply(&displacement, &mut force);
        for (f, u) in force.chunks_exact(3).zip(modes.displacements().chunks_exact(rank)) {
            for row in 0..rank {
                stiffness[row * rank + column] += u[row].x * f[0] + u[row].y * f[1] + u[row].z * f[2];
            }
        }
    }
    symmetrised(rank, &stiffness)
}

/// The mean of a matrix (row-major) and its mirror image.
///
/// # Errors
/// When it is not rank x rank, an entry is out of range, or the two differ by more than rounding.
pub(crate) fn symmetrised(rank: usize, matrix: &[f64]) -> Result<Vec<f64>, ModesError> {
    if rank.checked_mul(rank) != Some(matrix.len()) {
        return Err(ModesError::StiffnessLength { found: matrix.len(), rank });
    }
    if let Some(at) = matrix.iter().position(|x| x.is_nan() || x.abs() > limits::LARGEST) {
        return Err(ModesError::StiffnessEntry { row: at / rank, column: at % rank, value: matrix[at] });
    }
    let largest = matrix.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut mean = matrix.to_vec();
    for row in 0..rank {
        for column in 0..row {
            let [entry, mirrored] = [matrix[row * rank + column], matrix[column * rank + row]];
            if (entry - mirrored).abs() > SYMMETRY_SHARE * largest {
                return Err(ModesError::StiffnessAsymmetric { row, column, entry, mirrored });
            }
            let x = (entry + mirrored) / 2.0;
            mean[row * rank + column] = x;
            mean[column * rank + row] = x;
        }
    }
    Ok(mean)
}
