//! The motion of the demo: a spring shaken with growing amplitude.

use sscc::ReducedModel;
use sscc_io::Rows;

/// Number of frames: three seconds at thirty frames a second.
const FRAMES: usize = 90;

/// `|z|` of the last frame, as a multiple of the root radius.
const MAX_NORM: f64 = 4.0;

/// Returns one q for each frame of the demo; `root_radius` is that of the model. Every mode swings with its own frequency,
/// and the amplitude grows from 0. The numbers are the same on every machine.
pub fn demo_animation(model: &ReducedModel, root_radius: f64) -> Rows {
    let rank = model.rank();
    let mut data = Vec::with_capacity(FRAMES * rank);
    for frame in 0..FRAMES {
        let time = frame as f64 / (FRAMES - 1) as f64;
        let z: Vec<f64> = (0..rank).map(|k| swing(k, time)).collect();
        let norm = z.iter().map(|x| x * x).sum::<f64>().sqrt();
        let goal = MAX_NORM * root_radius * time;
        data.extend(z.iter().zip(model.metric().scales()).map(|(x, scale)| x * goal / (norm * scale)));
    }
    Rows { rows: FRAMES, columns: rank, data }
}

/// Returns the displacement of mode k at a time from 0 to 1. Higher modes have smaller amplitudes.
fn swing(k: usize, time: f64) -> f64 {
    let (k, turn) = (k as f64, std::f64::consts::TAU);
    libm::sin(turn * ((3.0 + 0.37 * k) * time + 0.17 * k)) / (1.0 + 0.25 * k)
}
