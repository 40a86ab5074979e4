//! The sound of a simulation.

use crate::run::FinishedRun;

/// How loud the loudest sample of a sound of 16 bits is.
const LOUDEST: f64 = 0.9;

/// Samples, one for each step.
#[derive(Clone, Debug, PartialEq)]
pub struct SoundTrack {
    /// As they were computed.
    pub samples: Vec<f64>,
    /// Samples in a second.
    pub rate: u32,
}

impl SoundTrack {
    /// The sound of a simulation; none where its scene has none.
    pub fn of(run: &FinishedRun) -> Option<Self> {
        run.scene.sound?;
        let samples = (0..run.history.len()).map(|state| run.history.step(state).sound).collect();
        Some(Self { samples, rate: (1.0 / run.scene.step).round() as u32 })
    }

    /// The samples, scaled to the loudness of `sound.wav`.
    pub fn normalized(&self) -> Vec<f64> {
        let peak = self.samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        self.samples.iter().map(|x| x * LOUDEST / peak.max(f64::MIN_POSITIVE)).collect()
    }
}
