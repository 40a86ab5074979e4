//! Example shapes as elastic bodies, reduced as in the paper's Table 1.
//!
//! Bodies are free, embedded in a lattice of cubes, and of the default [`Material`]. The metric is strain energy
//! (section 6).

use sscc::{Progress, ReducedModel, TriMesh};
use sscc_solid::{Elasticity, Material};

use super::{hare, spring};
use crate::{EmbeddedSurface, ModesError, SolidModes, linear_modes, nonlinear_modes};

/// Number of cubes along the spring. The wire is about two cubes thick, so the lowest frequency is too high: it is 8%
/// lower in a lattice more than twice as fine.
const SPRING_CELLS: usize = 30;

/// A shape with modes and forces.
pub struct ElasticShape {
    /// Surface with its modes.
    pub model: ReducedModel,
    /// Elastic forces. The stiffness at rest is diagonal, with squared angular frequencies (1/s^2), ascending.
    pub elasticity: Elasticity,
}

/// Returns the [`spring`] with 20 linear modes, its lowest vibrations.
///
/// # Errors
/// When memory is short or the work is cancelled.
pub fn elastic_spring(progress: &dyn Progress) -> Result<ElasticShape, ModesError> {
    let spring = spring();
    let body = EmbeddedSurface::new(&spring, Some(SPRING_CELLS), Material::default(), progress)?;
    let found = linear_modes(body.solid(), &[], 20, progress)?;
    shape(spring, &body, found)
}

/// Returns the [`hare`] with 30 nonlinear modes, a basis for large deformations.
///
/// # Errors
/// As [`elastic_spring`].
pub fn elastic_hare(progress: &dyn Progress) -> Result<ElasticShape, ModesError> {
    let hare = hare();
    let body = EmbeddedSurface::new(&hare, None, Material::default(), progress)?;
    let found = nonlinear_modes(body.solid(), &[], 30, progress)?;
    shape(hare, &body, found)
}

fn shape(surface: TriMesh, body: &EmbeddedSurface, found: SolidModes) -> Result<ElasticShape, ModesError> {
    let modes = body.on_surface(&found.modes)?;
    let model = ReducedModel::with_metric(surface, modes, found.energy_metric()?)?;
    Ok(ElasticShape { model, elasticity: found.elasticity })
}
