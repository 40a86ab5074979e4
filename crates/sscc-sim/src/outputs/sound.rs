//! The samples of a simulation's sound.

use crate::run::FinishedRun;

/// Peak of the 16-bit samples, as a share of their range.
const PEAK: f64 = 0.9;

/// Samples, one for each step.
#[derive(Clone, Debug, PartialEq)]
pub struct SoundTrack {
    /// Samples, not scaled.
    pub samples: Vec<f64>,
    /// Samples per second.
    pub rate: u32,
}

impl SoundTrack {
    /// Returns the sound of a simulation; None if its scene has no sound.
    pub fn of(run: &FinishedRun) -> Option<Self> {
        run.scene.sound?;
        let samples = (0..run.history.len()).map(|state| run.history.step(state).sound).collect();
        Some(Self { samples, rate: (1.0 / run.scene.step).round() as u32 })
    }

    /// Returns the samples, scaled to the peak of `sound.wav`.
    pub fn normalized(&self) -> Vec<f64> {
        let peak = self.samples.iter().fold(0.0_f64, |peak, x| peak.max(x.abs()));
        self.samples.iter().map(|x| x * PEAK / peak.max(f64::MIN_POSITIVE)).collect()
    }
}
