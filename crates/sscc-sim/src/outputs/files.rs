//! Writes the files of a simulation from its states.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use sscc_io::{WavFormat, write_wav, write_whole};

use super::animation::animation;
use super::arrays::{costs, trajectories};
use super::sound::SoundTrack;
use crate::error::{Result, SimError};
use crate::files::OUTPUT_FILES;
use crate::run::FinishedRun;

/// Files in the folder of a simulation, and errors of files that were not written. Numbers of a motion that diverges may not
/// fit a file format.
pub struct Outputs {
    folder: PathBuf,
    /// Indices in [`OUTPUT_FILES`] of the files that were written.
    written: Vec<usize>,
    unwritten: Vec<(usize, SimError)>,
}

impl Outputs {
    /// Writes the summary, trajectories, costs, the animation and the sound.
    pub fn write(run: &FinishedRun) -> Self {
        let mut outputs = Self { folder: run.folder.clone(), written: Vec::new(), unwritten: Vec::new() };
        outputs.add("summary.json", |path| {
            let json = serde_json::to_vec_pretty(&run.summary);
            let json = json.map_err(|error| SimError::refused(path.display(), error.to_string()))?;
            Ok(write_whole(path, &json)?)
        });
        outputs.add("trajectories.npz", |path| trajectories(path, run));
        outputs.add("costs.npz", |path| costs(path, run));
        outputs.add("animation.glb", |path| animation(path, run));
        if let Some(sound) = SoundTrack::of(run) {
            let SoundTrack { samples, rate } = &sound;
            outputs
                .add("sound.wav", |path| Ok(write_wav(path, *rate, &sound.normalized(), WavFormat::Pcm16)?));
            outputs.add("sound_float.wav", |path| Ok(write_wav(path, *rate, samples, WavFormat::Float32)?));
        }
        outputs
    }

    /// Writes the report, or stores its error.
    pub fn add_report(&mut self, html: Result<String, impl Display>) {
        self.add("report.html", |path| {
            let html = html.map_err(|error| SimError::refused(path.display(), error.to_string()))?;
            Ok(write_whole(path, html.as_bytes())?)
        });
    }

    /// Writes one file, or stores its error.
    fn add(&mut self, name: &str, write: impl FnOnce(&Path) -> Result<()>) {
        let place = OUTPUT_FILES.iter().position(|known| *known == name).unwrap_or(OUTPUT_FILES.len() - 1);
        match write(&self.folder.join(OUTPUT_FILES[place])) {
            Ok(()) => self.written.push(place),
            Err(error) => self.unwritten.push((place, error)),
        }
        self.written.sort_unstable();
    }

    /// Returns the files that were written.
    pub fn files(&self) -> Vec<PathBuf> {
        self.written.iter().map(|place| self.folder.join(OUTPUT_FILES[*place])).collect()
    }

    /// Returns the result of the simulation.
    ///
    /// # Errors
    /// When the simulation, or the measurement after it, was cancelled or ended early; else when a file was not written:
    /// the error is that of the first such file.
    pub fn finish(self, run: FinishedRun) -> Result<(), SimError> {
        let folder = self.folder;
        let unwritten = self.unwritten.into_iter().min_by_key(|(place, _)| *place);
        let unwritten = unwritten.map(|(_, error)| Box::new(error));
        match (run.failure, run.unmeasured) {
            (None, None) => unwritten.map_or(Ok(()), |error| Err(*error)),
            (Some(failure), _) if failure.is_cancelled() => {
                Err(SimError::Interrupted { steps: run.history.len() })
            }
            (Some(failure), _) => Err(SimError::EndedEarly { failure: Box::new(failure), folder, unwritten }),
            (None, Some(failure)) => {
                Err(SimError::Unmeasured { failure: Box::new(failure), folder, unwritten })
            }
        }
    }
}
