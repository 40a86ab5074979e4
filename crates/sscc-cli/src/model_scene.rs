//! A model with its certificates, as the page shows it.

use sscc::Certificates;
use sscc_io::LoadedModel;
use sscc_modes::mode_frequencies;
use sscc_view::{Arrays, ModelDetails, ModelScene, ViewError};

/// Returns the description of a model and its arrays. `q` is the initial q; None uses that of the file.
///
/// # Errors
/// If the certificates belong to another model, or a number of the model exceeds the range of the page.
pub fn model_scene(
    loaded: &LoadedModel,
    certificates: &Certificates,
    name: &str,
    q: Option<Vec<f64>>,
) -> Result<(ModelScene, Arrays), ViewError> {
    let details = ModelDetails {
        frequencies: loaded.info.elasticity.as_ref().and_then(|known| mode_frequencies(known.stiffness())),
        mode_names: loaded.mode_names.clone(),
        deviations: loaded.info.deviations.clone(),
        default_q: q.or_else(|| loaded.default_q.clone()),
    };
    let mut arrays = Arrays::default();
    let scene = ModelScene::new(0, name, &loaded.model, certificates, details, &mut arrays)?;
    Ok((scene, arrays))
}
