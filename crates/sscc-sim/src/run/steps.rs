//! Loop over the steps of a simulation: continues from the last checkpoint, and keeps all states if it ends early.

use std::path::Path;
use std::time::{Duration, Instant};

use cpu_time::ThreadTime;
use sscc_dynamics::{DynamicsError, SoundBank, World};
use sscc_io::Setting;
use sscc_tasks::{Stage, Watch, check_cancelled};

use super::clock::SystemClocks;
use super::history::{History, StateLayout};
use super::log::StateLog;
use super::prepared::PreparedScene;
use super::stepper::Stepper;
use super::world::{restore, world};
use crate::error::SimError;
use crate::files::remove_outputs;
use crate::scenes::Scene;

/// Time from one checkpoint to the next.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(10);

/// Number of values in memory at which they are appended to the log.
const MAX_PENDING_NUMBERS: usize = 1 << 14;

/// Maximum size of the log (4 GB). All outputs are created from it in memory.
const MAX_LOG_BYTES: f64 = 4e9;

/// The result of the loop over the steps.
pub struct RunOutcome {
    /// All states, at most as many as steps were requested.
    pub history: History,
    /// Processor time of this thread for all steps; None if an earlier run made some of them.
    pub processor_seconds: Option<f64>,
    /// Error that ended the simulation early, if any.
    pub failure: Option<SimError>,
}

/// Simulates a scene up to a number of steps. Continues from the checkpoint in the folder, unless `again` is set. `watch`
/// receives the lines of the announcement before the first step.
///
/// # Errors
/// When a body or the world of the scene is invalid, for example because bodies penetrate each other, themselves or the
/// ground at the start; when the states would take more than 4 GB; when the folder cannot be written to, has damaged
/// files or files that are not of a simulation, or belongs to another simulation. Divergence and cancellation are not
/// errors: [`RunOutcome::failure`] holds them, and the states are kept.
pub fn run(
    scene: &Scene,
    prepared: &PreparedScene,
    folder: &Path,
    steps: usize,
    again: bool,
    announcement: &[String],
    watch: &dyn Watch,
) -> Result<RunOutcome, SimError> {
    check_log_size(scene, prepared, steps)?;
    let mut world = world(scene, prepared)?;
    let mut sounds: Vec<Option<SoundBank>> =
        scene.bodies.iter().map(|body| prepared.models[body.model].sound.clone()).collect();
    let layout = state_layout(scene, prepared);
    let (mut log, checkpoint) = StateLog::open(folder, prepared.digest(scene), layout.clone(), again)?;
    if again {
        remove_outputs(folder)?;
    }
    if let Some(checkpoint) = checkpoint {
        restore(&mut world, &mut sounds, checkpoint.states, &checkpoint.memory)?;
    }
    announcement.iter().for_each(|line| watch.inform(line));
    // A single body is tested and moved only by the calling thread.
    let is_one_thread = scene.bodies.len() == 1 || rayon::current_num_threads() == 1;
    let mut stepper = Stepper::new(world, sounds, layout, SystemClocks::new(is_one_thread));
    let is_whole = log.len() == 0;
    let processor = ThreadTime::now();
    let mut last = Instant::now();
    let (mut failure, mut can_continue) = (None, true);
    watch.begin(Stage::Steps { step: scene.step });
    watch.report(log.len(), steps);
    while log.len() + stepper.pending_states() < steps {
        if let Err(error) = check_cancelled(watch) {
            failure = Some(error.into());
            break;
        }
        if let Err(error) = stepper.step() {
            failure = Some(diverged(error, &stepper.world));
            can_continue = false;
            break;
        }
        if stepper.pending_numbers() >= MAX_PENDING_NUMBERS {
            log.append(&stepper.take())?;
        }
        if last.elapsed() >= CHECKPOINT_INTERVAL {
            log.append(&stepper.take())?;
            log.write_checkpoint(&stepper.memory())?;
            last = Instant::now();
        }
        watch.report(log.len() + stepper.pending_states(), steps);
    }
    let processor_seconds = is_whole.then(|| processor.elapsed().as_secs_f64());
    log.append(&stepper.take())?;
    // No simulation can continue from a state that diverged.
    if can_continue {
        log.write_checkpoint(&stepper.memory())?;
    }
    Ok(RunOutcome { history: log.history()?.first(steps), processor_seconds, failure })
}

/// Checks the size of the log.
///
/// # Errors
/// When the states of so many steps would take more than 4 GB.
pub fn check_log_size(scene: &Scene, prepared: &PreparedScene, steps: usize) -> Result<(), SimError> {
    let bytes = 8.0 * steps as f64 * state_layout(scene, prepared).width() as f64;
    if bytes > MAX_LOG_BYTES {
        let place = format!("{steps} steps need {:.0} GB", bytes / 1e9);
        return Err(SimError::refused(place, "choose fewer with " + Setting::Steps));
    }
    Ok(())
}

fn state_layout(scene: &Scene, prepared: &PreparedScene) -> StateLayout {
    let rank = |model: usize| prepared.models[model].certified.model.rank();
    StateLayout::new(scene.bodies.iter().map(|body| rank(body.model)))
}

/// Returns the error of a diverging motion with its step, body and energy.
fn diverged(error: DynamicsError, world: &World) -> SimError {
    let (body, energy, cause) = match error {
        DynamicsError::Diverged { body, energy, .. } => (body, energy, String::new()),
        other => {
            // If numbers are out of range, the body of the highest energy is the cause.
            let energies = world.bodies().iter().map(|body| body.energy());
            let key = |energy: f64| if energy.is_nan() { f64::INFINITY } else { energy };
            let fastest = energies.enumerate().max_by(|a, b| key(a.1).total_cmp(&key(b.1)));
            let (body, energy) = fastest.unwrap_or_default();
            (body, energy, format!(": {other}"))
        }
    };
    SimError::Diverged { step: world.steps(), time: world.time(), body, energy, cause }
}
