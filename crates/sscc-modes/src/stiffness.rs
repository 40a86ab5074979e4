//! Reduced stiffness matrices `K~ = U'KU` (paper, section 6).

use sscc::Modes;
use sscc_solid::Stiffness;

use crate::ModesError;

/// Returns the reduced stiffness matrix `U'KU` (exactly symmetric) of a stiffness matrix `K` (3V x 3V, force per
/// length), given as an operator: `apply(u, force)` receives a displacement `u` (3V, vertex by vertex) and overwrites
/// `force` (3V) with `K u`.
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
/// assert_eq!(stiffness.entries(), [0.0, 0.0, 0.0, 5.0]);
/// # Ok::<(), sscc_modes::ModesError>(())
/// ```
///
/// # Errors
/// When `U'KU` is not finite, beyond 2^200 or not symmetric: see [`Stiffness::new`].
pub fn reduced_stiffness(
    modes: &Modes,
    mut apply: impl FnMut(&[f64], &mut [f64]),
) -> Result<Stiffness, ModesError> {
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
    let mean = Stiffness::new(rank, stiffness)?.symmetrised();
    Ok(Stiffness::new(rank, mean)?)
}
