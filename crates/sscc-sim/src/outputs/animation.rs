//! Writes the motion of a simulation as a glTF animation.

use std::path::Path;

use sscc_io::gltf::{NamedModel, Track, key_frames, write_animation};

use crate::error::Result;
use crate::run::FinishedRun;
use crate::scenes::BodySpec;

/// Writes rigid motions and weights of morph targets as glTF.
pub fn animation(path: &Path, run: &FinishedRun) -> Result<()> {
    let FinishedRun { scene, prepared, history, .. } = run;
    let frames = key_frames(history.len(), scene.step, scene.frames_per_second);
    let times: Vec<f64> = frames.iter().map(|state| run.time(*state)).collect();
    let certified = prepared.models.iter().map(|model| &model.certified);
    let models: Vec<NamedModel<'_>> =
        certified.map(|model| NamedModel { name: &model.name, model: &model.model }).collect();
    let track = |(body, spec): (usize, &BodySpec)| {
        let at = || frames.iter().map(|state| history.body(*state, body));
        Track {
            name: format!("{} {body}", models[spec.model].name),
            model: spec.model,
            center: prepared.models[spec.model].center(),
            positions: at().map(|facts| facts.position).collect(),
            orientations: at().map(|facts| facts.orientation).collect(),
            weights: at().flat_map(|facts| facts.q).copied().collect(),
        }
    };
    let tracks: Vec<Track> = scene.bodies.iter().enumerate().map(track).collect();
    Ok(write_animation(path, &models, &times, &tracks)?)
}
