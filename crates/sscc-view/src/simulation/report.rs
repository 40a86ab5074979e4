//! Reports of simulations: the page with the recorded motion, as one HTML file.

use sscc::Progress;
use sscc_modes::mode_frequencies;
use sscc_sim::FinishedRun;
use sscc_tasks::text::one_line;

use super::playback::playback;
use super::plots::{energy, sound};
use crate::{Arrays, ModelDetails, ModelScene, Report, Scene, ViewError};

/// Returns the report of a simulation as one HTML file. Omits the colliding triangles if `progress` cancels.
///
/// # Errors
/// If a number of a model exceeds the range of the page.
pub fn simulation_report(run: &FinishedRun, progress: &dyn Progress) -> Result<String, ViewError> {
    let mut arrays = Arrays::default();
    let mut scene = Scene::new(&run.scene.name);
    for (index, model) in run.prepared.models.iter().enumerate() {
        let certified = &model.certified;
        let details = ModelDetails {
            frequencies: mode_frequencies(certified.elasticity.stiffness()),
            ..ModelDetails::default()
        };
        let (name, certificates) = (&certified.name, &certified.full.certificates);
        let made = ModelScene::new(index, name, &certified.model, certificates, details, &mut arrays);
        let named = |error| ViewError::Model { name: name.clone(), error: Box::new(error) };
        scene.models.push(made.map_err(named)?);
    }
    let stopped = run.failure.iter().map(|error| ("stopped early", error));
    let failures =
        stopped.chain(run.unmeasured.iter().map(|error| ("traditional method not measured", error)));
    let failures = failures.map(|(what, error)| (what.to_owned(), one_line(&error.to_string())));
    scene.summary = failures.chain(run.summary.table()).collect();
    scene.plots.push(energy(run));
    if run.scene.sound.is_some() {
        scene.plots.push(sound(run));
    }
    let (playback, notes) = playback(run, progress, &mut arrays)?;
    scene.playback = playback;
    scene.summary.extend(notes.into_iter().map(|note| ("note".to_owned(), note)));
    Ok(Report { scene, arrays, checks: None }.html()?)
}
