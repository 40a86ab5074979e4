//! A simulation at work: it goes on from its last checkpoint, and keeps what it has when it fails.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, Error, Result, anyhow, ensure};
use cpu_time::ThreadTime;
use sscc_dynamics::{DynamicsError, Phase, SoundBank, Start, State, World};

use super::clock::{Clocks, StepClock, StepTimes, SystemClocks};
use super::history::{BodyFacts, History, Layout, StepFacts};
use super::log::Log;
use super::meter::Meter;
use super::outputs;
use super::prepared::Prepared;
use crate::interrupt;
use crate::scene::{BodySpec, Scene};

/// A checkpoint is written so often.
const CHECKPOINT: Duration = Duration::from_secs(10);

/// So many numbers of states are kept in memory before they are appended to the log.
const KEPT: usize = 1 << 14;

/// The largest log: all outputs are made from it in memory.
const MOST_BYTES: f64 = 4e9;

/// The energy is computed at every so many steps.
pub const ENERGY_STEPS: usize = 8;

/// What became of a simulation.
pub struct Ran {
    pub history: History,
    /// Processor time of this thread for all steps; none where some were made by another process.
    pub processor_seconds: Option<f64>,
    /// Why it ended early, if it did.
    pub failure: Option<Error>,
}

/// Lets a scene move for so many steps, or goes on with what is in the folder (unless it is to begin `again`). Checks
/// first that it can begin.
///
/// # Errors
/// When bodies begin in each other, in themselves or in the ground; when the folder cannot be written to. Of a
/// motion that diverges, and of Ctrl-C, [`Ran::failure`] tells: the states so far are there.
pub fn run(
    scene: &Scene,
    prepared: &Prepared,
    folder: &Path,
    steps: usize,
    again: bool,
    meter: &Meter,
) -> Result<Ran> {
    let mut world = world(scene, prepared)?;
    let mut sounds: Vec<Option<SoundBank>> =
        scene.bodies.iter().map(|body| prepared.models[body.model].sound.clone()).collect();
    let layout = Layout::new(scene.bodies.iter().map(|body| prepared.models[body.model].case.model.rank()));
    let bytes = 8.0 * steps as f64 * layout.width() as f64;
    ensure!(bytes <= MOST_BYTES, "{steps} steps take {:.0} GB: take fewer by --steps", bytes / 1e9);
    let (mut log, checkpoint) = Log::open(folder, prepared.digest(scene)?, layout.clone(), again)?;
    if again {
        outputs::remove(folder)?;
    }
    if let Some(checkpoint) = checkpoint {
        let at = checkpoint.states;
        restore(&mut world, &mut sounds, at, &checkpoint.memory).context("the checkpoint")?;
    }
    // One body is tested and moved by the thread that calls.
    let is_one_thread = scene.bodies.len() == 1 || rayon::current_num_threads() == 1;
    let mut simulation = Simulation::new(world, sounds, layout, SystemClocks::new(is_one_thread));
    let is_whole = log.len() == 0;
    let processor = ThreadTime::now();
    let mut last = Instant::now();
    let (mut failure, mut can_go_on) = (None, true);
    meter.start(log.len());
    while log.len() + simulation.waiting() < steps {
        if let Err(error) = interrupt::check() {
            failure = Some(error);
            break;
        }
        if let Err(error) = simulation.step() {
            failure = Some(named(error, &simulation.world));
            can_go_on = false;
            break;
        }
        if simulation.numbers.len() >= KEPT {
            log.append(&simulation.take())?;
        }
        if last.elapsed() >= CHECKPOINT {
            log.append(&simulation.take())?;
            log.write_checkpoint(&simulation.memory())?;
            last = Instant::now();
        }
        meter.report(log.len() + simulation.waiting(), steps, scene.step);
    }
    let processor_seconds = is_whole.then(|| processor.elapsed().as_secs_f64());
    log.append(&simulation.take())?;
    // What diverged is no place to go on from.
    if can_go_on {
        log.write_checkpoint(&simulation.memory())?;
    }
    Ok(Ran { history: log.history()?.first(steps), processor_seconds, failure })
}

/// The bodies of a scene at its beginning.
fn world<'a>(scene: &Scene, prepared: &'a Prepared) -> Result<World<'a>> {
    let mut world = World::new(scene.options())?;
    for (number, body) in scene.bodies.iter().enumerate() {
        let BodySpec { model, position, orientation, velocity, angular_velocity, shake } = body;
        let model = &prepared.models[*model];
        let mut v = shake.clone();
        v.resize(model.case.model.rank(), 0.0);
        let start = Start {
            position: Some(*position),
            orientation: *orientation * model.upright,
            velocity: *velocity,
            spin: *angular_velocity,
            v,
            damping: scene.models[body.model].damping,
            detection: scene.detection,
            ..Start::default()
        };
        world.add(&model.shape, &start).with_context(|| format!("body {number} (counted from 0)"))?;
    }
    world.check_start()?;
    Ok(world)
}

fn restore(
    world: &mut World<'_>,
    sounds: &mut [Option<SoundBank>],
    step: usize,
    memory: &[f64],
) -> Result<()> {
    let all: usize = sounds.iter().flatten().map(|bank| bank.state().len()).sum();
    let (numbers, mut rest) = memory.split_at_checked(memory.len().saturating_sub(all)).unwrap_or_default();
    world.restore(&State { step: step as u64, numbers: numbers.to_vec() })?;
    for bank in sounds.iter_mut().flatten() {
        let (own, others) = rest.split_at_checked(bank.state().len()).context("it is too short")?;
        bank.restore(own)?;
        rest = others;
    }
    Ok(())
}

/// Names step, body and energy.
fn named(error: DynamicsError, world: &World<'_>) -> Error {
    let (body, energy, cause) = match error {
        DynamicsError::Diverged { body, energy, .. } => (body, energy, String::new()),
        other => {
            // Of what leaves the range of numbers, the fastest body is the cause.
            let energies = world.bodies().iter().map(|body| body.energy());
            let key = |energy: f64| if energy.is_nan() { f64::INFINITY } else { energy };
            let fastest = energies.enumerate().max_by(|a, b| key(a.1).total_cmp(&key(b.1)));
            let (body, energy) = fastest.unwrap_or_default();
            (body, energy, format!(": {other}"))
        }
    };
    let (step, time) = (world.steps(), world.time());
    anyhow!(
        "step {step} ({time:.4} s): the motion of body {body} (counted from 0) diverges (energy {energy:.3e} J){cause}; take more steps in a \
         second, or more damping"
    )
}

struct Simulation<'a, C> {
    world: World<'a>,
    sounds: Vec<Option<SoundBank>>,
    layout: Layout,
    clock: StepClock<C>,
    /// States that are not yet in the log.
    numbers: Vec<f64>,
    /// Where those begin whose processor time is not yet known.
    unsettled: usize,
}

impl<'a, C: Clocks> Simulation<'a, C> {
    fn new(world: World<'a>, sounds: Vec<Option<SoundBank>>, layout: Layout, clocks: C) -> Self {
        Self { world, sounds, layout, clock: StepClock::new(clocks), numbers: Vec::new(), unsettled: 0 }
    }

    /// The states that are not yet in the log, to be put there.
    fn take(&mut self) -> Vec<f64> {
        self.settle();
        self.unsettled = 0;
        std::mem::take(&mut self.numbers)
    }

    /// Gives the last states their processor time.
    fn settle(&mut self) {
        let factor = self.clock.settle();
        self.layout.scale_seconds(factor, &mut self.numbers[self.unsettled..]);
        self.unsettled = self.numbers.len();
    }

    fn waiting(&self) -> usize {
        self.numbers.len() / self.layout.width()
    }

    /// One step, and the state before it, of which the step tells what collides in it.
    fn step(&mut self) -> Result<(), DynamicsError> {
        let has_energy = self.world.steps().is_multiple_of(ENERGY_STEPS as u64);
        let energy = if has_energy { self.world.energy() } else { f64::NAN };
        let start = self.numbers.len();
        let bodies = self.world.bodies().iter().map(|body| BodyFacts {
            pairs: 0,
            position: body.rigid().position,
            orientation: body.rigid().orientation,
            q: body.q(),
        });
        self.layout.push(StepFacts::default(), bodies, &mut self.numbers);
        let begin = self.clock.begin();
        let clock = &mut self.clock;
        let advanced = self.world.advance(&mut |phase| clock.enter(part(phase)));
        self.clock.enter(Some(SOUND));
        let sound = self.hear();
        let StepTimes { parts: seconds, wall } = self.clock.end(begin);
        let inter_pairs = self.world.inter_pairs().map(|(_, pairs)| pairs.len()).sum();
        let facts = StepFacts { seconds, wall, energy, sound, inter_pairs };
        let pairs = self.world.bodies().iter().map(|body| body.pairs().len());
        self.layout.complete(facts, pairs, &mut self.numbers[start..]);
        if self.clock.is_due() {
            self.settle();
        }
        // The state from which it could not go on is kept, too.
        advanced.map(drop)
    }

    fn hear(&mut self) -> f64 {
        for impulse in self.world.impulses() {
            if let Some(bank) = &mut self.sounds[impulse.body] {
                bank.strike(impulse);
            }
        }
        self.sounds.iter_mut().flatten().map(SoundBank::sample).sum()
    }

    /// What going on needs.
    fn memory(&self) -> Vec<f64> {
        let mut memory = self.world.state().numbers;
        self.sounds.iter().flatten().for_each(|bank| memory.extend(bank.state()));
        memory
    }
}

/// The part of [`PARTS`] that is sound.
const SOUND: usize = 5;

/// The place in [`PARTS`] of a phase.
fn part(phase: Phase) -> Option<usize> {
    match phase {
        Phase::SelfCollision => Some(0),
        Phase::InterObject => Some(1),
        Phase::Ground => Some(2),
        Phase::Penalty => Some(3),
        Phase::Dynamics => Some(4),
        Phase::Done => None,
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use sscc_dynamics::WorldOptions;

    use super::*;

    /// Each look at the wall's clock takes a millisecond, a tenth of which this thread works.
    #[derive(Default)]
    struct Busy {
        looks: Cell<u32>,
    }

    impl Clocks for Busy {
        fn wall(&self) -> f64 {
            self.looks.set(self.looks.get() + 1);
            1e-3 * f64::from(self.looks.get())
        }

        fn processor(&self) -> f64 {
            1e-4 * f64::from(self.looks.get())
        }

        fn is_one_thread(&self) -> bool {
            true
        }
    }

    #[test]
    fn costs_are_processor_time() {
        let world = World::new(WorldOptions::default()).unwrap();
        let layout = Layout::new([]);
        let mut simulation = Simulation::new(world, Vec::new(), layout.clone(), Busy::default());
        (0..3).for_each(|_| simulation.step().unwrap());
        let history = History::new(layout, simulation.take());
        for state in 0..3 {
            let facts = history.facts(state);
            // Each part lasts from one look to the next.
            assert!(facts.seconds.iter().all(|seconds| (0.5e-4..1.5e-4).contains(seconds)), "{facts:?}");
            assert!(facts.wall > 6e-3, "{facts:?}");
        }
    }
}
