//! Advances a world with its sounds, and records each step.

use sscc_dynamics::{DynamicsError, Phase, SoundBank, World};

use super::clock::{Clocks, StepClock, StepTimes};
use super::history::{BodyRecord, StateLayout, StepRecord};

/// Number of steps from one computation of the energy to the next.
const ENERGY_STEPS: usize = 8;

/// A world that advances, with the states that are not yet in the log.
pub struct Stepper<C> {
    pub world: World,
    sounds: Vec<Option<SoundBank>>,
    layout: StateLayout,
    clock: StepClock<C>,
    /// States that are not yet in the log.
    numbers: Vec<f64>,
    /// Index of the first number whose block of costs has not ended.
    block_start: usize,
}

impl<C: Clocks> Stepper<C> {
    pub fn new(world: World, sounds: Vec<Option<SoundBank>>, layout: StateLayout, clocks: C) -> Self {
        Self { world, sounds, layout, clock: StepClock::new(clocks), numbers: Vec::new(), block_start: 0 }
    }

    /// Removes and returns the states that are not yet in the log, so that they can be appended.
    pub fn take(&mut self) -> Vec<f64> {
        self.end_block();
        self.block_start = 0;
        std::mem::take(&mut self.numbers)
    }

    /// Ends the block of costs: scales them to processor time.
    fn end_block(&mut self) {
        let factor = self.clock.end_block();
        self.layout.scale_seconds(factor, &mut self.numbers[self.block_start..]);
        self.block_start = self.numbers.len();
    }

    /// Returns the number of values that are not yet in the log.
    pub fn pending_numbers(&self) -> usize {
        self.numbers.len()
    }

    /// Returns the number of states that are not yet in the log.
    pub fn pending_states(&self) -> usize {
        self.numbers.len() / self.layout.width()
    }

    /// Advances by one step, and records the state before it with the collisions that the step detects.
    pub fn step(&mut self) -> Result<(), DynamicsError> {
        let has_energy = self.world.steps().is_multiple_of(ENERGY_STEPS as u64);
        let energy = if has_energy { self.world.energy() } else { f64::NAN };
        let asleep = self.world.bodies().iter().filter(|body| body.is_asleep()).count();
        let start = self.numbers.len();
        let bodies = self.world.bodies().iter().map(|body| BodyRecord {
            pairs: 0,
            position: body.rigid().position,
            orientation: body.rigid().orientation,
            q: body.q(),
        });
        self.layout.push(StepRecord::default(), bodies, &mut self.numbers);
        let begin = self.clock.begin();
        let clock = &mut self.clock;
        let advanced = self.world.advance(&mut |phase| clock.enter(part(phase)));
        self.clock.enter(Some(SOUND));
        let sound = self.sample_sound();
        let StepTimes { parts: seconds, wall } = self.clock.end(begin);
        let inter_pairs = self.world.inter_pairs().map(|found| found.pairs.len()).sum();
        let facts = StepRecord { seconds, wall, energy, sound, inter_pairs, asleep };
        let pairs = self.world.bodies().iter().map(|body| body.pairs().len());
        self.layout.complete(facts, pairs, &mut self.numbers[start..]);
        if self.clock.is_due() {
            self.end_block();
        }
        // The last state is kept even if its step failed.
        advanced.map(drop)
    }

    /// Applies the impulses of the step to the sounds. Returns the sum of their samples.
    fn sample_sound(&mut self) -> f64 {
        for impulse in self.world.impulses() {
            if let Some(bank) = &mut self.sounds[impulse.body] {
                bank.strike(impulse);
            }
        }
        self.sounds.iter_mut().flatten().map(SoundBank::sample).sum()
    }

    /// Returns the state of world and sounds, for a checkpoint.
    pub fn memory(&self) -> Vec<f64> {
        let mut memory = self.world.state().numbers;
        self.sounds.iter().flatten().for_each(|bank| memory.extend(bank.state()));
        memory
    }
}

/// Index of sound in `STEP_PARTS`.
const SOUND: usize = 5;

/// Returns the index of a phase in `STEP_PARTS`.
fn part(phase: Phase) -> Option<usize> {
    match phase {
        Phase::SelfCollision => Some(0),
        Phase::InterObject => Some(1),
        Phase::Ground => Some(2),
        Phase::Contacts => Some(3),
        Phase::Dynamics => Some(4),
        Phase::Done => None,
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use sscc_dynamics::WorldOptions;

    use super::super::history::History;

    use super::*;

    /// Clocks of a thread that works during a tenth of the time. Each reading of the wall clock takes a millisecond.
    #[derive(Default)]
    struct Busy {
        readings: Cell<u32>,
    }

    impl Clocks for Busy {
        fn wall(&self) -> f64 {
            self.readings.set(self.readings.get() + 1);
            1e-3 * f64::from(self.readings.get())
        }

        fn processor(&self) -> f64 {
            1e-4 * f64::from(self.readings.get())
        }

        fn is_one_thread(&self) -> bool {
            true
        }
    }

    #[test]
    fn costs_are_processor_time() {
        let world = World::new(WorldOptions::default()).unwrap();
        let layout = StateLayout::new([]);
        let mut stepper = Stepper::new(world, Vec::new(), layout.clone(), Busy::default());
        (0..3).for_each(|_| stepper.step().unwrap());
        let history = History::new(layout, stepper.take());
        for state in 0..3 {
            let facts = history.step(state);
            // Each part lasts from one reading to the next.
            assert!(facts.seconds.iter().all(|seconds| (0.5e-4..1.5e-4).contains(seconds)), "{facts:?}");
            assert!(facts.wall > 6e-3, "{facts:?}");
        }
    }
}
