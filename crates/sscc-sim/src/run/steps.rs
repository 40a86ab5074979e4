//! The loop over the steps of a simulation: continues from the last checkpoint, and keeps all states when it ends early.

use std::path::Path;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use sscc_dynamics::{DynamicsError, SoundBank, World};

use super::clock::SystemClocks;
use super::history::{History, StateLayout};
use super::log::StateLog;
use super::prepared::PreparedScene;
use super::stepper::Stepper;
use super::world::{restore, world};
use crate::error::SimError;
use crate::files::remove_outputs;
use crate::scenes::Scene;
use crate::watch::{Stage, Watch, check_cancelled};

/// A checkpoint is written so often.
const CHECKPOINT: Duration = Duration::from_secs(10);

/// So many numbers of states are kept in memory before they are appended to the log.
const KEPT: usize = 1 << 14;

/// The largest log: all outputs are made from it in memory.
const MOST_BYTES: f64 = 4e9;

/// The result of the loop over the steps.
pub struct RunOutcome {
    /// Its states.
    pub history: History,
    /// Processor time of this thread for all steps; none where some were made by another process.
    pub processor_seconds: Option<f64>,
    /// Why it ended early, if it did.
    pub failure: Option<SimError>,
}

/// Simulates a scene up to a number of steps. Continues from the checkpoint in the folder, unless it is to begin `again`.
///
/// # Errors
/// When bodies begin in each other, in themselves or in the ground; when the folder cannot be written to. A motion that
/// diverges and a cancellation are no errors but [`RunOutcome::failure`]: their states are kept.
pub fn run(
    scene: &Scene,
    prepared: &PreparedScene,
    folder: &Path,
    steps: usize,
    again: bool,
    watch: &dyn Watch,
) -> Result<RunOutcome, SimError> {
    let mut world = world(scene, prepared)?;
    let mut sounds: Vec<Option<SoundBank>> =
        scene.bodies.iter().map(|body| prepared.models[body.model].sound.clone()).collect();
    let rank = |model: usize| prepared.models[model].certified.model.rank();
    let layout = StateLayout::new(scene.bodies.iter().map(|body| rank(body.model)));
    let bytes = 8.0 * steps as f64 * layout.width() as f64;
    if bytes > MOST_BYTES {
        let place = format!("{steps} steps take {:.0} GB", bytes / 1e9);
        return Err(SimError::refused(place, "take fewer by --steps"));
    }
    let (mut log, checkpoint) = StateLog::open(folder, prepared.digest(scene), layout.clone(), again)?;
    if again {
        remove_outputs(folder)?;
    }
    if let Some(checkpoint) = checkpoint {
        restore(&mut world, &mut sounds, checkpoint.states, &checkpoint.memory)?;
    }
    // One body is tested and moved by the thread that calls.
    let is_one_thread = scene.bodies.len() == 1 || rayon::current_num_threads() == 1;
    let mut stepper = Stepper::new(world, sounds, layout, SystemClocks::new(is_one_thread));
    let is_whole = log.len() == 0;
    let processor = ThreadTime::now();
    let mut last = Instant::now();
    let (mut failure, mut can_go_on) = (None, true);
    watch.begin(Stage::Steps { step: scene.step });
    watch.report(log.len(), steps);
    while log.len() + stepper.waiting() < steps {
        if let Err(error) = check_cancelled(watch) {
            failure = Some(error);
            break;
        }
        if let Err(error) = stepper.step() {
            failure = Some(diverged(error, &stepper.world));
            can_go_on = false;
            break;
        }
        if stepper.pending() >= KEPT {
            log.append(&stepper.take())?;
        }
        if last.elapsed() >= CHECKPOINT {
            log.append(&stepper.take())?;
            log.write_checkpoint(&stepper.memory())?;
            last = Instant::now();
        }
        watch.report(log.len() + stepper.waiting(), steps);
    }
    let processor_seconds = is_whole.then(|| processor.elapsed().as_secs_f64());
    log.append(&stepper.take())?;
    // No simulation can continue from a state that diverged.
    if can_go_on {
        log.write_checkpoint(&stepper.memory())?;
    }
    Ok(RunOutcome { history: log.history()?.first(steps), processor_seconds, failure })
}

/// Names step, body and energy.
fn diverged(error: DynamicsError, world: &World<'_>) -> SimError {
    let (body, energy, cause) = match error {
        DynamicsError::Diverged { body, energy, .. } => (body, energy, String::new()),
        other => {
            // Where numbers leave their range, the body of the highest energy is the cause.
            let energies = world.bodies().iter().map(|body| body.energy());
            let key = |energy: f64| if energy.is_nan() { f64::INFINITY } else { energy };
            let fastest = energies.enumerate().max_by(|a, b| key(a.1).total_cmp(&key(b.1)));
            let (body, energy) = fastest.unwrap_or_default();
            (body, energy, format!(": {other}"))
        }
    };
    SimError::Diverged { step: world.steps(), time: world.time(), body, energy, cause }
}
