//! Modes of solids: vibrations, nonlinear bases and polynomial modes.

use faer::Mat;
use glam::DVec3;
use sscc::{Metric, Modes, Progress, TriMesh};
use sscc_solid::{Elasticity, ReducedForces, Solid, Stiffness};

use crate::body::{Body, whitening};
use crate::eigen::dense::symmetric_eigen;
use crate::eigen::fix_signs;
use crate::eigen::tall_matrix::{inner, product};
use crate::elasticity::reduced_forces;
use crate::{DEFAULT_ELL, ModesError, energy_metric, filter_eigenvalues, nonlinear};

/// Modes of a solid's vertices with identity mass and diagonal stiffness at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidModes {
    /// Modes of the solid's vertices, mass-orthonormal (1 / root of mass). Fixed vertices do not move.
    pub modes: Modes,
    /// Elastic forces. The stiffness at rest is diagonal.
    pub elasticity: Elasticity,
}

impl SolidModes {
    /// Returns the stiffness of each mode, ascending: its squared angular frequency (1/s^2). Linear modes have natural
    /// frequencies, other modes upper bounds of them.
    pub fn eigenvalues(&self) -> Vec<f64> {
        self.elasticity.stiffness().diagonal().collect()
    }

    /// Returns the frequency of each mode (Hz, if the material is in SI units).
    pub fn frequencies(&self) -> Vec<f64> {
        self.eigenvalues().iter().map(|x| x.sqrt() / std::f64::consts::TAU).collect()
    }

    /// Returns the strain energy as a metric for these modes (paper, section 6). Frequencies of modes that are not linear
    /// may be very high, so their weights are filtered.
    ///
    /// # Errors
    /// When an eigenvalue is negative or so small that its half is 0.
    pub fn energy_metric(&self) -> Result<Metric, ModesError> {
        let eigenvalues = self.eigenvalues();
        match self.elasticity {
            Elasticity::Linear(_) => energy_metric(&eigenvalues),
            Elasticity::Nonlinear(_) => energy_metric(&filter_eigenvalues(&eigenvalues, DEFAULT_ELL)?),
        }
    }
}

/// Computes the `rank` lowest vibrations of a solid: `K x = lambda M x` (linear modal analysis; paper, section 6),
/// without the rigid motions that the `fixed` vertices permit (six for a free body).
///
/// A small problem is solved completely. In others the inertia of `K - sigma M` counts the eigenvalues up to a gap
/// after the last one, so none is missing.
///
/// # Errors
/// When a fixed vertex does not exist, all are fixed, the body has fewer modes, parts of the body share only an edge or a
/// vertex, memory is short, or the work is cancelled.
pub fn linear_modes(
    solid: &Solid,
    fixed: &[u32],
    rank: usize,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    let body = Body::new(solid, fixed)?;
    let lowest = body.lowest(rank, progress)?;
    let columns: Vec<Vec<DVec3>> = (0..rank).map(|k| body.on_all(lowest.vectors.col_as_slice(k))).collect();
    let elasticity = Elasticity::Linear(Stiffness::from_diagonal(&lowest.eigenvalues)?);
    Ok(SolidModes { modes: from_columns(&columns)?, elasticity })
}

/// Computes a basis of rank `rank` for large deformations, with its reduced St. Venant-Kirchhoff forces (Barbic and James
/// 2005; the paper's nonlinear models): the strongest directions of linear modes and their modal derivatives, by a
/// mass-weighted principal component analysis. The basis is rotated so that the stiffness at rest is diagonal.
///
/// # Errors
/// As [`linear_modes`], and when `rank` is 0 or larger than 100.
pub fn nonlinear_modes(
    solid: &Solid,
    fixed: &[u32],
    rank: usize,
    progress: &dyn Progress,
) -> Result<SolidModes, ModesError> {
    if rank == 0 {
        return Err(sscc::Error::RankZero.into());
    }
    if rank > MAX_NONLINEAR_RANK {
        return Err(ModesError::NonlinearRank { requested: rank, max: MAX_NONLINEAR_RANK });
    }
    let body = Body::new(solid, fixed)?;
    let basis = nonlinear::basis(&body, rank, progress)?;
    // The basis has no rigid motions, so low eigenvalues belong to soft directions.
    let (transform, eigenvalues) = rotation(&body, &basis, 0.0)?;
    if eigenvalues.len() < rank {
        return Err(ModesError::TooManyModes { requested: rank, available: eigenvalues.len() });
    }
    let vectors = product(basis.as_ref(), transform.as_ref());
    let columns: Vec<Vec<DVec3>> = (0..rank).map(|k| body.on_all(vectors.col_as_slice(k))).collect();
    let modes = from_columns(&columns)?;
    let forces = reduced_forces(solid, &modes, progress)?;
    Ok(SolidModes { modes, elasticity: nonlinear_elasticity(forces, &eigenvalues)? })
}

/// Polynomial modes of a solid and of a surface that moves with it.
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialModes {
    /// Modes of the solid's vertices, with their forces.
    pub solid: SolidModes,
    /// The same modes for the vertices of the surface.
    pub surface: Modes,
}

/// Computes the quadratic polynomial modes of a free solid and of a surface that moves with it (paper, section 7),
/// rotated so that the mass is the identity and the stiffness diagonal (section 6). Without rigid motions 24 modes
/// remain, fewer for small solids.
///
/// # Errors
/// As [`linear_modes`].
pub fn polynomial_solid_modes(
    solid: &Solid,
    surface: &TriMesh,
    progress: &dyn Progress,
) -> Result<PolynomialModes, ModesError> {
    let body = Body::new(solid, &[])?;
    let vertices = solid.vertices();
    let low = vertices.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
    let high = vertices.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
    let (centre, size) = ((low + high) * 0.5, (high - low).max_element());
    let fields = |points: &[DVec3]| {
        Mat::from_fn(3 * points.len(), 3 * MONOMIALS, |row, k| {
            let p = (points[row / 3] - centre) / size;
            let scalars =
                [1.0, p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.y * p.z, p.z * p.x, p.x * p.y];
            if k % 3 == row % 3 { scalars[k / 3] } else { 0.0 }
        })
    };
    let (transform, eigenvalues) = rotation(&body, &fields(vertices), RIGID_TOLERANCE)?;
    let on = |points: &[DVec3]| {
        let fields = product(fields(points).as_ref(), transform.as_ref());
        let column = |k| fields.col_as_slice(k).chunks_exact(3).map(DVec3::from_slice).collect();
        from_columns(&(0..transform.ncols()).map(column).collect::<Vec<_>>())
    };
    let (modes, surface) = (on(vertices)?, on(surface.rest_positions())?);
    let forces = reduced_forces(solid, &modes, progress)?;
    let solid = SolidModes { modes, elasticity: nonlinear_elasticity(forces, &eigenvalues)? };
    Ok(PolynomialModes { solid, surface })
}

/// Replaces the linear part of forces, which is diagonal up to rounding, by the exact diagonal.
fn nonlinear_elasticity(forces: ReducedForces, eigenvalues: &[f64]) -> Result<Elasticity, ModesError> {
    Ok(Elasticity::Nonlinear(forces.with_linear(Stiffness::from_diagonal(eigenvalues)?)?))
}

/// Maximum number of modes for large deformations. Memory grows with the fourth power (cubic terms) and with the number
/// of pairs of modes (derivatives): about 4 GB at the default resolution, by calculation.
const MAX_NONLINEAR_RANK: usize = 100;

/// Number of monomials of degree 2 or less in three variables.
const MONOMIALS: usize = 10;

/// Maximum eigenvalue of a rigid motion, relative to the largest.
const RIGID_TOLERANCE: f64 = 1e-11;

/// Returns the matrix T for which the columns of `X T` are M-orthonormal with a diagonal stiffness, and that diagonal.
/// Dependent columns are removed, and motions whose stiffness is at most `rigid` times the largest.
fn rotation(body: &Body, basis: &Mat<f64>, rigid: f64) -> Result<(Mat<f64>, Vec<f64>), ModesError> {
    let orthonormal = whitening(&body.mass, basis, 1e-13, basis.ncols())?;
    let stiffness = inner(basis.as_ref(), body.stiffness.multiply(basis.as_ref()).as_ref());
    let stiffness = product(stiffness.as_ref(), orthonormal.as_ref());
    let (values, vectors) = symmetric_eigen(inner(orthonormal.as_ref(), stiffness.as_ref()).as_ref())?;
    let size = values.len();
    let kept: Vec<usize> = (0..size).filter(|k| values[*k] > rigid * values[size - 1]).collect();
    let vectors = Mat::from_fn(size, kept.len(), |i, j| vectors[(i, kept[j])]);
    let mut transform = product(orthonormal.as_ref(), vectors.as_ref());
    fix_signs(&mut transform);
    Ok((transform, kept.into_iter().map(|k| values[k]).collect()))
}

/// Returns modes from one displacement field each.
fn from_columns(columns: &[Vec<DVec3>]) -> Result<Modes, ModesError> {
    let vertices = columns.first().map_or(0, Vec::len);
    let displacements = (0..vertices).flat_map(|v| columns.iter().map(move |column| column[v])).collect();
    Ok(Modes::new(columns.len(), displacements)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_solid::Material;

    /// A bar of six cubes along x.
    fn bar() -> Solid {
        let corner = |at: usize| {
            DVec3::new((at / 4) as f64, 0.8 * f64::from(u8::from(at % 4 > 1)), [0.0, 0.7][at % 2])
        };
        let cube = |k: u32| [0, 4, 6, 2, 1, 5, 7, 3].map(|corner| 4 * k + corner);
        let (vertices, cubes) = ((0..28).map(corner).collect(), (0..6).map(cube).collect());
        Solid::uniform(vertices, vec![], cubes, Material::default()).unwrap()
    }

    #[test]
    fn the_linear_part_of_reduced_forces_is_diagonal() {
        let paths = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
        let tets = bar().cubes().iter().flat_map(|cube| paths.map(|path| path.map(|k| cube[k]))).collect();
        let tets = Solid::uniform(bar().vertices().to_vec(), tets, vec![], Material::default()).unwrap();
        check(&bar());
        check(&tets.elevated().unwrap().0);
    }

    fn check(solid: &Solid) {
        let surface = solid.boundary().unwrap().mesh;
        let nonlinear = nonlinear_modes(solid, &[0, 1, 2, 3], 8, &()).unwrap();
        let polynomial = polynomial_solid_modes(solid, &surface, &()).unwrap().solid;
        for found in [nonlinear, polynomial] {
            let eigenvalues = found.eigenvalues();
            let rank = eigenvalues.len();
            let forces = reduced_forces(solid, &found.modes, &()).unwrap();
            for (at, entry) in forces.linear().entries().iter().enumerate() {
                let expected = if at / rank == at % rank { eigenvalues[at / rank] } else { 0.0 };
                assert!((entry - expected).abs() < 1e-9 * eigenvalues[rank - 1], "{at}: {entry} {expected}");
            }
            assert!(found.elasticity.stiffness().is_diagonal());
        }
    }
}
