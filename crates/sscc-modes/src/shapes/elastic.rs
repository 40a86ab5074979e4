//! The example shapes as elastic bodies, reduced as in the paper's Table 1: free, in a lattice of cubes, of the default
//! [`Material`]; the metric is strain energy (section 6).

use sscc::{Progress, ReducedModel, TriMesh};

use super::{hare, spring};
use crate::{
    DEFAULT_ELL, Embedded, Material, ModesError, ReducedForces, SolidModes, energy_metric,
    filter_eigenvalues, linear_modes, nonlinear_modes,
};

/// Cubes along the spring. A wire is about two thick, which makes it a little stiff: in a lattice more than twice as
/// fine its lowest frequency is 8% lower.
const SPRING_CELLS: usize = 30;

/// A shape with modes and forces.
pub struct ElasticShape {
    /// The surface with its modes.
    pub model: ReducedModel,
    /// The stiffness of each mode, ascending: its angular frequency (1/s), squared.
    pub eigenvalues: Vec<f64>,
    /// The forces of large deformations; none where modes are linear.
    pub forces: Option<ReducedForces>,
}

/// The [`spring`] with 20 linear modes: its lowest vibrations.
///
/// # Errors
/// When memory is short or the work is cancelled.
pub fn elastic_spring(progress: &dyn Progress) -> Result<ElasticShape, ModesError> {
    let spring = spring();
    let body = Embedded::new(&spring, Some(SPRING_CELLS), Material::default(), progress)?;
    let found = linear_modes(body.solid(), &[], 20, progress)?;
    let weights = found.eigenvalues.clone();
    shape(spring, &body, found, &weights)
}

/// The [`hare`] with 30 nonlinear modes, a basis for large deformations.
///
/// # Errors
/// As [`elastic_spring`].
pub fn elastic_hare(progress: &dyn Progress) -> Result<ElasticShape, ModesError> {
    let hare = hare();
    let body = Embedded::new(&hare, None, Material::default(), progress)?;
    let found = nonlinear_modes(body.solid(), &[], 30, progress)?;
    let weights = filter_eigenvalues(&found.eigenvalues, DEFAULT_ELL)?;
    shape(hare, &body, found, &weights)
}

fn shape(
    surface: TriMesh,
    body: &Embedded,
    found: SolidModes,
    weights: &[f64],
) -> Result<ElasticShape, ModesError> {
    let modes = body.on_surface(&found.modes)?;
    let model = ReducedModel::with_metric(surface, modes, energy_metric(weights)?)?;
    Ok(ElasticShape { model, eigenvalues: found.eigenvalues, forces: found.forces })
}
