//! States of a simulation and the record of each step, in one array of numbers.

use glam::{DQuat, DVec3};

/// The parts of a step that are timed, in the order of [`StepRecord::seconds`].
pub const STEP_PARTS: [&str; 6] = ["self", "inter_object", "ground", "penalty", "dynamics", "sound"];

/// Number of values of a step, without those of its bodies.
const STEP_NUMBERS: usize = STEP_PARTS.len() + 5;

/// Number of values of a body, without its q.
const BODY_NUMBERS: usize = 8;

/// Record of a step: its cost and its sound, with energy and collisions of the state at its beginning.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepRecord {
    /// Processor time of each part (s).
    pub seconds: [f64; STEP_PARTS.len()],
    /// Wall-clock time of the step (s).
    pub wall: f64,
    /// Sum of kinetic, elastic and potential energy (J); NaN if it was not computed.
    pub energy: f64,
    /// Sample of the sound during the step; 0 without sound.
    pub sound: f64,
    /// Number of colliding triangle pairs between bodies in the state.
    pub inter_pairs: usize,
    /// Number of bodies that sleep in the state.
    pub asleep: usize,
}

impl StepRecord {
    /// Returns the processor time of detecting self-collisions (s).
    pub fn self_seconds(&self) -> f64 {
        self.seconds[0]
    }

    /// Returns the processor time of the whole step (s).
    pub fn total_seconds(&self) -> f64 {
        self.seconds.iter().sum()
    }

    fn numbers(&self) -> [f64; STEP_NUMBERS] {
        let mut numbers = [self.energy; STEP_NUMBERS];
        numbers[..STEP_PARTS.len()].copy_from_slice(&self.seconds);
        numbers[STEP_PARTS.len() + 1] = self.sound;
        numbers[STEP_PARTS.len() + 2] = self.inter_pairs as f64;
        numbers[STEP_PARTS.len() + 3] = self.wall;
        numbers[STEP_PARTS.len() + 4] = self.asleep as f64;
        numbers
    }
}

/// A body in a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyRecord<'a> {
    /// Number of colliding triangle pairs within the body.
    pub pairs: usize,
    /// Its centre of mass.
    pub position: DVec3,
    /// Rotation from the axes of its model to those of the world.
    pub orientation: DQuat,
    /// Its reduced coordinates.
    pub q: &'a [f64],
}

/// Layout of the numbers of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StateLayout {
    /// Index of the first number of each body, then the length of a step.
    starts: Vec<usize>,
}

impl StateLayout {
    /// Creates the layout for bodies of these ranks.
    pub fn new(ranks: impl IntoIterator<Item = usize>) -> Self {
        let mut starts = vec![STEP_NUMBERS];
        for rank in ranks {
            starts.push(starts[starts.len() - 1] + BODY_NUMBERS + rank);
        }
        Self { starts }
    }

    /// Returns the number of bodies.
    pub fn bodies(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the number of modes of a body.
    pub fn rank(&self, body: usize) -> usize {
        self.starts[body + 1] - self.starts[body] - BODY_NUMBERS
    }

    /// Returns the number of values of a step.
    pub fn width(&self) -> usize {
        self.starts[self.bodies()]
    }

    /// Appends a step to `numbers`. `bodies` must fit the layout.
    pub fn push<'a>(
        &self,
        facts: StepRecord,
        bodies: impl IntoIterator<Item = BodyRecord<'a>>,
        numbers: &mut Vec<f64>,
    ) {
        numbers.extend(facts.numbers());
        for BodyRecord { pairs, position, orientation, q } in bodies {
            numbers.push(pairs as f64);
            numbers.extend(position.to_array());
            numbers.extend(orientation.to_array());
            numbers.extend(q);
        }
        debug_assert_eq!(numbers.len() % self.width(), 0);
    }

    /// Sets the values of a state that are known after its step: the record, and the pairs of each body.
    pub fn complete(&self, facts: StepRecord, pairs: impl Iterator<Item = usize>, state: &mut [f64]) {
        state[..STEP_NUMBERS].copy_from_slice(&facts.numbers());
        for (start, pairs) in self.starts.iter().zip(pairs) {
            state[*start] = pairs as f64;
        }
    }

    /// Multiplies the seconds of all parts in `states` by a factor.
    pub fn scale_seconds(&self, factor: f64, states: &mut [f64]) {
        for state in states.chunks_exact_mut(self.width()) {
            state[..STEP_PARTS.len()].iter_mut().for_each(|seconds| *seconds *= factor);
        }
    }
}

/// States of a simulation, from its beginning.
#[derive(Clone, Debug, PartialEq)]
pub struct History {
    layout: StateLayout,
    numbers: Vec<f64>,
}

impl History {
    /// Creates the history from the numbers of whole steps.
    pub fn new(layout: StateLayout, numbers: Vec<f64>) -> Self {
        debug_assert_eq!(numbers.len() % layout.width(), 0);
        Self { layout, numbers }
    }

    /// Returns the first `states` states, or all if there are fewer.
    pub fn first(mut self, states: usize) -> Self {
        self.numbers.truncate(states.saturating_mul(self.layout.width()));
        self
    }

    /// Returns the layout of its steps.
    pub fn layout(&self) -> &StateLayout {
        &self.layout
    }

    /// Returns the number of states.
    pub fn len(&self) -> usize {
        self.numbers.len() / self.layout.width()
    }

    /// Whether there is no state.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    fn of(&self, state: usize) -> &[f64] {
        &self.numbers[state * self.layout.width()..][..self.layout.width()]
    }

    /// Returns the record of the step that begins with a state.
    pub fn step(&self, state: usize) -> StepRecord {
        let of = self.of(state);
        let seconds = std::array::from_fn(|part| of[part]);
        let [energy, sound, inter_pairs, wall, asleep] = [0, 1, 2, 3, 4].map(|n| of[STEP_PARTS.len() + n]);
        let [inter_pairs, asleep] = [inter_pairs, asleep].map(|count| count as usize);
        StepRecord { seconds, wall, energy, sound, inter_pairs, asleep }
    }

    /// Returns a body in a state.
    pub fn body(&self, state: usize, body: usize) -> BodyRecord<'_> {
        let of = &self.of(state)[self.layout.starts[body]..self.layout.starts[body + 1]];
        BodyRecord {
            pairs: of[0] as usize,
            position: DVec3::new(of[1], of[2], of[3]),
            orientation: DQuat::from_array([of[4], of[5], of[6], of[7]]),
            q: &of[BODY_NUMBERS..],
        }
    }

    /// Returns all bodies in a state.
    pub fn bodies(&self, state: usize) -> impl Iterator<Item = BodyRecord<'_>> {
        (0..self.layout.bodies()).map(move |body| self.body(state, body))
    }

    /// Whether a body moves in the step from a state, or in the last step before the end. A sleeping body does not move.
    pub fn moves(&self, state: usize, body: usize) -> bool {
        let next = if state + 1 < self.len() { state + 1 } else { state.saturating_sub(1) };
        let [a, b] = [state, next].map(|state| self.body(state, body));
        state == next || (a.position, a.orientation, a.q) != (b.position, b.orientation, b.q)
    }

    /// Returns the number of colliding triangle pairs within bodies in a state.
    pub fn self_pairs(&self, state: usize) -> usize {
        self.bodies(state).map(|body| body.pairs).sum()
    }

    /// Returns the number of bodies that collide with themselves in a state.
    pub fn colliding_bodies(&self, state: usize) -> usize {
        self.bodies(state).filter(|body| body.pairs > 0).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_history_returns_the_steps_that_were_appended() {
        let layout = StateLayout::new([2, 0]);
        let facts = |x: f64| StepRecord {
            seconds: std::array::from_fn(|part| x + part as f64),
            wall: 2.0 * x,
            energy: x + 0.5,
            sound: -x,
            inter_pairs: x as usize + 2,
            asleep: x as usize + 1,
        };
        let q = [[0.5, -1.0], [2.0, 3.0]];
        let body = |pairs: usize, q| BodyRecord {
            pairs,
            position: DVec3::new(1.0, 2.0, pairs as f64),
            orientation: DQuat::from_array([0.0, 0.6, 0.8, 0.0]),
            q,
        };
        let mut numbers = Vec::new();
        layout.push(facts(0.0), [body(0, &q[0]), body(0, &[])], &mut numbers);
        layout.push(facts(0.0), [body(0, &q[1]), body(0, &[])], &mut numbers);
        layout.complete(facts(10.0), [3, 7].into_iter(), &mut numbers[29..]);
        let history = History::new(layout, numbers);
        assert_eq!((history.len(), history.layout().width(), history.layout().rank(0)), (2, 29, 2));
        assert_eq!(
            (history.step(1), history.body(1, 0)),
            (facts(10.0), BodyRecord { position: body(0, &q[1]).position, ..body(3, &q[1]) })
        );
        assert_eq!(
            (history.step(0).total_seconds(), history.step(0).self_seconds(), history.body(1, 1).pairs),
            (15.0, 0.0, 7)
        );
        assert_eq!(
            (history.colliding_bodies(0), history.colliding_bodies(1), history.self_pairs(1)),
            (0, 2, 10)
        );
    }
}
