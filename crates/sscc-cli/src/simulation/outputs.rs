//! The files of a simulation, made from its states.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Error, Result};
use sscc_io::gltf::{Track, key_frames, write_animation};
use sscc_io::{NamedArray, WavFormat, write_npz, write_wav, write_whole};

use super::history::{History, PARTS};
use super::page::Page;
use super::prepared::Prepared;
use crate::scene::Scene;

/// How loud the loudest sample of the 16 bit file is; the other one is as loud as it was computed.
pub(super) const LOUDEST: f64 = 0.9;

/// What [`write`] may have left in a folder.
const FILES: [&str; 7] = [
    "summary.json",
    "report.html",
    "trajectories.npz",
    "costs.npz",
    "animation.glb",
    "sound.wav",
    "sound_float.wav",
];

/// Removes the files of a simulation that begins again: what it does not write must not seem to be its own.
pub fn remove(folder: &Path) -> Result<()> {
    FILES.iter().try_for_each(|name| remove_file(&folder.join(name)))
}

/// Removes a file, if it is there.
pub fn remove_file(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(error).with_context(|| path.display().to_string())
        }
        _ => Ok(()),
    }
}

/// Writes all of them into a folder. Gives the names of those that were written, and why another one was not: of
/// a motion that diverges some numbers may fit no file.
pub fn write(folder: &Path, page: &Page<'_>) -> (Vec<PathBuf>, Option<Error>) {
    let Page { scene, prepared, history, summary, .. } = *page;
    let (mut files, mut unwritten) = (Vec::new(), None);
    let mut add = |name: &str, write: &dyn Fn(&Path) -> Result<()>| {
        let path = folder.join(name);
        match write(&path) {
            Ok(()) => files.push(path),
            Err(error) => unwritten = unwritten.take().or(Some(error)),
        }
    };
    add("summary.json", &|path| Ok(write_whole(path, &serde_json::to_vec_pretty(summary)?)?));
    add("report.html", &|path| Ok(write_whole(path, page.html()?.as_bytes())?));
    add("trajectories.npz", &|path| trajectories(path, scene, prepared, history));
    add("costs.npz", &|path| costs(path, scene, history, page));
    add("animation.glb", &|path| animation(path, scene, prepared, history));
    if scene.sound.is_some() {
        let (samples, rate) = page.samples();
        let loud = loud(&samples, LOUDEST);
        add("sound.wav", &|path| Ok(write_wav(path, rate, &loud, WavFormat::Pcm16)?));
        add("sound_float.wav", &|path| Ok(write_wav(path, rate, &samples, WavFormat::Float32)?));
    }
    (files, unwritten)
}

/// Sound whose loudest sample is that loud.
pub(super) fn loud(samples: &[f64], loudest: f64) -> Vec<f64> {
    let peak = samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
    samples.iter().map(|x| x * loudest / peak.max(f64::MIN_POSITIVE)).collect()
}

/// Times of all states (s).
fn times(scene: &Scene, history: &History) -> Vec<f64> {
    (0..history.len()).map(|state| state as f64 * scene.step).collect()
}

/// All of the motion, to the bit.
fn trajectories(path: &Path, scene: &Scene, prepared: &Prepared, history: &History) -> Result<()> {
    let (states, bodies) = (history.len(), history.layout().bodies());
    let time = times(scene, history);
    let each = |of: &dyn Fn(usize, usize, &mut Vec<f64>)| {
        let mut values = Vec::new();
        (0..states).for_each(|state| (0..bodies).for_each(|body| of(state, body, &mut values)));
        values
    };
    let positions = each(&|s, b, to| to.extend(history.body(s, b).position.to_array()));
    let orientations = each(&|s, b, to| to.extend(history.body(s, b).orientation.to_array()));
    let pairs = each(&|s, b, to| to.push(history.body(s, b).pairs as f64));
    let inter: Vec<f64> = (0..states).map(|state| history.facts(state).inter_pairs as f64).collect();
    let (energy_time, energy): (Vec<f64>, Vec<f64>) = (0..states)
        .map(|state| (time[state], history.facts(state).energy))
        .filter(|(_, energy)| energy.is_finite())
        .unzip();
    let model_of: Vec<f64> = scene.bodies.iter().map(|body| body.model as f64).collect();
    let centers: Vec<f64> = prepared.models.iter().flat_map(|model| model.center().to_array()).collect();
    let of_models: Vec<(String, Vec<usize>, Vec<f64>)> = scene
        .models
        .iter()
        .enumerate()
        .filter_map(|(index, model)| {
            let of = |body: &usize| scene.bodies[*body].model == index;
            let own: Vec<usize> = (0..bodies).filter(of).collect();
            let first = own.first()?;
            let mut q = Vec::new();
            for state in 0..states {
                own.iter().for_each(|body| q.extend(history.body(state, *body).q));
            }
            Some((model.array_name(), vec![states, own.len(), history.layout().rank(*first)], q))
        })
        .collect();
    let mut arrays = vec![
        NamedArray { name: "time", shape: vec![states], values: &time },
        NamedArray { name: "positions", shape: vec![states, bodies, 3], values: &positions },
        NamedArray { name: "orientations", shape: vec![states, bodies, 4], values: &orientations },
        NamedArray { name: "self_pairs", shape: vec![states, bodies], values: &pairs },
        NamedArray { name: "inter_pairs", shape: vec![states], values: &inter },
        NamedArray { name: "energy_time", shape: vec![energy.len()], values: &energy_time },
        NamedArray { name: "energy", shape: vec![energy.len()], values: &energy },
        NamedArray { name: "model_of_body", shape: vec![bodies], values: &model_of },
        NamedArray { name: "centers", shape: vec![prepared.models.len(), 3], values: &centers },
    ];
    arrays.extend(of_models.iter().map(|(name, shape, values)| NamedArray {
        name,
        shape: shape.clone(),
        values,
    }));
    Ok(write_npz(path, &arrays)?)
}

/// What each step took, and the traditional method at some of them.
fn costs(path: &Path, scene: &Scene, history: &History, page: &Page<'_>) -> Result<()> {
    let time = times(scene, history);
    let parts: Vec<(String, Vec<f64>)> = PARTS
        .iter()
        .enumerate()
        .map(|(part, name)| {
            let of = |state| history.facts(state).seconds[part];
            (format!("{name}_seconds"), (0..history.len()).map(of).collect())
        })
        .collect();
    let (at, traditional): (Vec<f64>, Vec<f64>) =
        page.traditional.iter().map(|(state, seconds)| (*state as f64 * scene.step, *seconds)).unzip();
    let mut arrays = vec![
        line("time", &time),
        line("traditional_time", &at),
        line("traditional_self_seconds", &traditional),
    ];
    arrays.extend(parts.iter().map(|(name, values)| line(name, values)));
    Ok(write_npz(path, &arrays)?)
}

/// An array of one axis.
fn line<'a>(name: &'a str, values: &'a [f64]) -> NamedArray<'a> {
    NamedArray { name, shape: vec![values.len()], values }
}

fn animation(path: &Path, scene: &Scene, prepared: &Prepared, history: &History) -> Result<()> {
    let frames = key_frames(history.len(), scene.step, scene.frames_per_second);
    let times: Vec<f64> = frames.iter().map(|state| *state as f64 * scene.step).collect();
    let models: Vec<(&str, &sscc::ReducedModel)> =
        prepared.models.iter().map(|model| (model.case.name.as_str(), &model.case.model)).collect();
    let track = |(body, spec): (usize, &crate::scene::BodySpec)| {
        let at = || frames.iter().map(|state| history.body(*state, body));
        Track {
            name: format!("{} {body}", models[spec.model].0),
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
