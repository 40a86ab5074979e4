//! The example shapes as elastic bodies, reduced as in the paper's Table 1: free, in a lattice of cubes, of the default
//! [`Material`]; the metric is strain energy (section 6).

use sscc::{Progress, ReducedModel, TriMesh};
use sscc_solid::{Elasticity, Material};

use super::{hare, spring};
use crate::{EmbeddedSurface, ModesError, SolidModes, linear_modes, nonlinear_modes};

/// Cubes along the spring. A wire is about two thick, which makes it a little stiff: in a lattice more than twice as
/// fine its lowest frequency is 8% lower.
const SPRING_CELLS: usize = 30;

/// A shape with modes and forces.
pub struct ElasticShape {
    /// The surface with its modes.
    pub model: ReducedModel,
    /// The elastic forces. The stiffness at rest is diagonal: each mode's angular frequency (1/s), squared, ascending.
    pub elasticity: Elasticity,
}

/// The [`spring`] with 20 linear modes: its lowest vibrations.
///
/// # Errors
/// When memory is short or the work is cancelled.
pub fn elastic_spring(progress: &dyn Progress) -> Result<ElasticShape, ModesError> {
    let spring = spring();
    let body = EmbeddedSurface::new(&spring, Some(SPRING_CELLS), Material::default(), progress)?;
    let found = linear_modes(body.solid(), &[], 20, progress)?;
    shape(spring, &body, found)
}

/// The [`hare`] with 30 nonlinear modes, a basis for large deformations.
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
