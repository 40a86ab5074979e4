//! Models with polynomial modes of a surface without a volume.

use sscc::{ReducedModel, TriMesh};
use sscc_io::ModelInfo;
use sscc_modes::polynomial_modes;

use super::new_model::NewModel;
use crate::TaskError;

/// Computes a model with polynomial modes of a surface, without a volume and without stiffness. `name` is the name of the
/// surface, for the provenance.
///
/// # Errors
/// When the surface has no area, is too far from the origin for its size, or its modes are out of range.
pub fn polynomial_model(mesh: TriMesh, name: &str) -> Result<NewModel, TaskError> {
    let modes = polynomial_modes(&mesh)?;
    Ok(NewModel {
        model: ReducedModel::new(mesh, modes)?,
        info: ModelInfo::new("", format!("mesh {name}, polynomial modes")),
        solid: None,
        components: None,
    })
}
