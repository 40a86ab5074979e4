//! Linear modes: the lowest natural vibrations of a solid.

use faer::Mat;
use glam::DVec3;
use sscc::{Modes, Progress, TriMesh};

use crate::body::{Body, whitening};
use crate::eigen::dense::symmetric_eigen;
use crate::eigen::fix_signs;
use crate::eigen::tall::{inner, product};
use crate::elasticity::{ReducedForces, reduced_forces};
use crate::nonlinear;
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
    let lowest = body.lowest(rank, progress)?;
    let columns: Vec<Vec<DVec3>> = (0..rank).map(|k| body.on_all(lowest.vectors.col_as_slice(k))).collect();
    Ok(SolidModes { modes: from_columns(&columns)?, eigenvalues: lowest.eigenvalues, forces: None })
}

/// A basis of rank `rank` for large deformations, with its reduced St. Venant-Kirchhoff forces (Barbic and James 2005;
/// the paper's nonlinear models): linear modes and their modal derivatives, of which a mass-weighted principal
/// component analysis takes the strongest directions. In the end rotated such that the stiffness at rest is diagonal.
///
/// # Errors
/// As [`linear_modes`].
pub fn nonlinear_modes(
    solid: &Solid,
    fixed: &[u32],
    rank: usize,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    if rank == 0 {
        return Err(sscc::Error::RankZero.into());
    }
    if rank > MOST_NONLINEAR {
        return Err(ModesError::NonlinearRank { asked: rank, most: MOST_NONLINEAR });
    }
    let body = Body::new(solid, fixed)?;
    let basis = nonlinear::basis(&body, rank, progress)?;
    // Rigid motions are not in the basis: a soft direction is a soft one.
    let (turn, eigenvalues) = rotation(&body, &basis, 0.0)?;
    if eigenvalues.len() < rank {
        return Err(ModesError::TooManyModes { asked: rank, available: eigenvalues.len() });
    }
    let vectors = product(basis.as_ref(), turn.as_ref());
    let columns: Vec<Vec<DVec3>> = (0..rank).map(|k| body.on_all(vectors.col_as_slice(k))).collect();
    let modes = from_columns(&columns)?;
    let forces = Some(reduced_forces(solid, &modes, progress)?);
    Ok(SolidModes { modes, eigenvalues, forces })
}

/// The quadratic polynomial modes of a free solid (paper, section 7), rotated such that mass is the identity and the
/// stiffness diagonal (section 6): those of the solid's vertices, with their forces, and those of the vertices of a
/// surface that moves with it. Rigid motions are left out: 24 modes remain, fewer for small solids.
///
/// # Errors
/// As [`linear_modes`].
pub fn polynomial_solid_modes(
    solid: &Solid,
    surface: &TriMesh,
    progress: &dyn Progress,
) -> Result<(SolidModes, Modes), ModesError> {
    let body = Body::new(solid, &[])?;
    let vertices = solid.vertices();
    let low = vertices.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
    let high = vertices.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
    let (centre, size) = ((low + high) * 0.5, (high - low).max_element());
    let fields = |points: &[DVec3]| {
        Mat::from_fn(3 * points.len(), 3 * POLYNOMIALS, |row, k| {
            let p = (points[row / 3] - centre) / size;
            let scalars =
                [1.0, p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.y * p.z, p.z * p.x, p.x * p.y];
            if k % 3 == row % 3 { scalars[k / 3] } else { 0.0 }
        })
    };
    let (turn, eigenvalues) = rotation(&body, &fields(vertices), RIGID)?;
    let on = |points: &[DVec3]| {
        let fields = product(fields(points).as_ref(), turn.as_ref());
        let column = |k| fields.col_as_slice(k).chunks_exact(3).map(DVec3::from_slice).collect();
        from_columns(&(0..turn.ncols()).map(column).collect::<Vec<_>>())
    };
    let (modes, of_surface) = (on(vertices)?, on(surface.rest_positions())?);
    let forces = Some(reduced_forces(solid, &modes, progress)?);
    Ok((SolidModes { modes, eigenvalues, forces }, of_surface))
}

/// The most modes for large deformations: memory grows with the fourth power (the cubic terms) and with the number of
/// pairs of modes (their derivatives); by count, about 4 GB at the default resolution.
const MOST_NONLINEAR: usize = 100;

/// Monomials of degree 2 or less in three variables.
const POLYNOMIALS: usize = 10;

/// Eigenvalues of at most this share of the largest belong to rigid motions.
const RIGID: f64 = 1e-11;

/// The matrix T for which the columns of `X T` are M-orthonormal and their stiffness is diagonal, and that diagonal.
/// Dependent columns fall away, and motions whose stiffness is at most the share `rigid` of the largest.
fn rotation(body: &Body, basis: &Mat<f64>, rigid: f64) -> Result<(Mat<f64>, Vec<f64>), ModesError> {
    let orthonormal = whitening(&body.mass, basis, 1e-13, basis.ncols())?;
    let stiffness = inner(basis.as_ref(), body.stiffness.multiply(basis.as_ref()).as_ref());
    let stiffness = product(stiffness.as_ref(), orthonormal.as_ref());
    let (values, vectors) = symmetric_eigen(inner(orthonormal.as_ref(), stiffness.as_ref()).as_ref())?;
    let size = values.len();
    let kept: Vec<usize> = (0..size).filter(|k| values[*k] > rigid * values[size - 1]).collect();
    let vectors = Mat::from_fn(size, kept.len(), |i, j| vectors[(i, kept[j])]);
    let mut turn = product(orthonormal.as_ref(), vectors.as_ref());
    fix_signs(&mut turn);
    Ok((turn, kept.into_iter().map(|k| values[k]).collect()))
}

/// Modes from one field for each.
fn from_columns(columns: &[Vec<DVec3>]) -> Result<Modes, ModesError> {
    let vertices = columns.first().map_or(0, Vec::len);
    let displacements = (0..vertices).flat_map(|v| columns.iter().map(move |column| column[v])).collect();
    Ok(Modes::new(columns.len(), displacements)?)
}
