//! Models from the mean and the principal components of the frames of an animation.

use glam::DVec3;
use sscc::{Progress, ReducedModel, TriMesh};
use sscc_io::ModelInfo;
use sscc_modes::pca_modes;

use super::new_model::{Components, NewModel};
use crate::TaskError;

/// Computes a model from the mean and the principal components of frames with the faces of `mesh`. Without a rank it
/// has as many components as explain 99.9% of the variance. `name` describes the frames, for the provenance.
///
/// # Errors
/// When there are too few frames, one does not fit `mesh` or has a position out of range, all frames are equal, there
/// are fewer independent components than the rank, or `progress` cancels.
pub fn pca_model(
    mesh: &TriMesh,
    frames: &[Vec<DVec3>],
    rank: Option<usize>,
    name: &str,
    progress: &dyn Progress,
) -> Result<NewModel, TaskError> {
    let found = pca_modes(mesh, frames, rank, progress)?;
    let count = frames.len();
    let explained = found.shares.iter().sum();
    let mut info = ModelInfo::new("", format!("mean and principal components of {count} {name}"));
    // The modes are scaled by their standard deviations.
    info.deviations = Some(vec![1.0; found.modes.rank()]);
    Ok(NewModel {
        model: ReducedModel::new(found.mesh, found.modes)?,
        info,
        solid: None,
        components: Some(Components { frames: count, explained, deviations: found.deviations }),
    })
}
