//! Linear modes: the lowest natural vibrations of a solid.

use glam::DVec3;
use sscc::{Modes, Progress};

use crate::body::Body;
use crate::elasticity::{ReducedForces, reduced_forces};
use crate::nonlinear;
use crate::sparse::lowest_modes;
use crate::{ModesError, Solid};

/// Modes of a solid's vertices in which mass is the identity and the stiffness at rest is diagonal.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidModes {
    /// One displacement for each vertex of the solid and each mode; mass-orthonormal (1 / root of mass). Fixed
    /// vertices do not move.
    pub modes: Modes,
    /// The stiffness of each mode, ascending: its angular frequency (1/s), squared. For linear modes these are natural
    /// frequencies, for others an upper bound of them.
    pub eigenvalues: Vec<f64>,
    /// The forces of large deformations; none for linear modes, whose force is `eigenvalue q`.
    pub forces: Option<ReducedForces>,
}

impl SolidModes {
    /// Frequencies (Hz, if the material is in SI units).
    pub fn frequencies(&self) -> Vec<f64> {
        self.eigenvalues.iter().map(|x| x.sqrt() / std::f64::consts::TAU).collect()
    }
}

/// The `rank` lowest vibrations of a solid: `K x = lambda M x` (linear modal analysis; paper, section 6). Rigid motions
/// that the `fixed` vertices allow are left out: six of a free body.
///
/// None is missed: eigenvalues below the last one are counted by the inertia of `K - sigma M`.
///
/// # Errors
/// When a fixed vertex does not exist, all are fixed, there are fewer modes, parts of the body hang together by an edge
/// or a vertex only, memory is short, or the work is cancelled.
pub fn linear_modes(
    solid: &Solid,
    fixed: &[u32],
    rank: usize,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    let body = Body::new(solid, fixed)?;
    let pencil = body.pencil();
    let shift = pencil.shift();
    let symbolic = body.symbolic()?;
    let factor = pencil.factor(&symbolic, shift)?;
    let lowest = lowest_modes(&pencil, &symbolic, &factor, shift, rank, progress)?;
    let columns: Vec<Vec<DVec3>> =
        (0..rank).map(|k| body.on_all(lowest.vectors.col_as_slice(k))).collect();
    Ok(SolidModes { modes: from_columns(&columns)?, eigenvalues: lowest.eigenvalues, forces: None })
}

/// A basis of rank `rank` for large deformations, with its reduced St. Venant-Kirchhoff forces (Barbic and James 2005;
/// the paper's nonlinear models): linear modes and their modal derivatives, of which a mass-weighted principal component
/// analysis takes the strongest directions. In the end rotated such that the stiffness at rest is diagonal.
///
/// # Errors
/// As [`linear_modes`].
pub fn nonlinear_modes(
    solid: &Solid,
    fixed: &[u32],
    rank: usize,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    let body = Body::new(solid, fixed)?;
    let basis = nonlinear::basis(&body, rank, progress)?;
    in_basis(&body, basis, true, progress)
}

/// The same span as the columns of `modes` (say polynomial ones, evaluated at the solid's vertices), rotated such that
/// mass is the identity and the stiffness diagonal (paper, section 6): `U' = U Q`. Dependent modes fall away, and so do
/// rigid motions of a body that is not fixed.
///
/// # Errors
/// As [`linear_modes`].
pub fn modes_of_span(
    solid: &Solid,
    fixed: &[u32],
    modes: &Modes,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    let body = Body::new(solid, fixed)?;
    let r = modes.rank();
    let column = |k: usize| -> Vec<f64> {
        body.on_free(&modes.displacements().iter().skip(k).step_by(r).copied().collect::<Vec<_>>())
    };
    let columns: Vec<Vec<f64>> = (0..r).map(column).collect();
    let basis = faer::Mat::from_fn(columns[0].len(), r, |i, j| columns[j][i]);
    in_basis(&body, basis, false, progress)
}

/// Mass-orthonormal modes with a diagonal stiffness that span the given columns, and their forces.
fn in_basis(
    body: &Body,
    mut basis: faer::Mat<f64>,
    with_forces: bool,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    let pencil = body.pencil();
    pencil.without_rigid(&mut basis);
    let basis = crate::body::m_orthonormal(&body.mass, basis, 1e-14, usize::MAX)?;
    let stiffness = basis.transpose() * body.stiffness.multiply(basis.as_ref());
    let eigen = stiffness.self_adjoint_eigen(faer::Side::Lower).map_err(|_| ModesError::NoEigenvalues)?;
    let mut vectors = &basis * eigen.U();
    crate::sparse::fix_signs(&mut vectors);
    let rank = vectors.ncols();
    let columns: Vec<Vec<DVec3>> = (0..rank).map(|k| body.on_all(vectors.col_as_slice(k))).collect();
    let modes = from_columns(&columns)?;
    let forces = match with_forces {
        true => Some(reduced_forces(body.solid, &modes, progress)?),
        false => None,
    };
    Ok(SolidModes { modes, eigenvalues: (0..rank).map(|k| eigen.S()[k]).collect(), forces })
}

/// Modes from one field for each.
fn from_columns(columns: &[Vec<DVec3>]) -> Result<Modes, ModesError> {
    let vertices = columns.first().map_or(0, Vec::len);
    let displacements = (0..vertices).flat_map(|v| columns.iter().map(move |column| column[v])).collect();
    Ok(Modes::new(columns.len(), displacements)?)
}
