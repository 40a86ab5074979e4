//! Times all methods, interleaved.
//!
//! The methods run one after the other on blocks of steps. Other load of the machine then affects all of them alike.
//! Each method finds the data of its own last query in the processor's caches, as in a program that uses one method
//! only.

use super::clock::{median, milliseconds};
use super::step::Step;
use crate::error::Error;
use crate::methods::{COLUMNS, Column, Engine};
use crate::progress::Counter;

/// Repetitions of each method on each block of steps; the time of a step is their median.
pub const REPETITIONS: usize = 3;

/// Number of steps in a block. Only in the first step of each block, the caches contain the data of another method.
const BLOCK: usize = 20;

/// Milliseconds by step and column; None where a method did not run on a step.
pub type Milliseconds = Vec<Vec<Option<f64>>>;

/// The queries of one step by one method.
pub type Queries<'q> = &'q dyn Fn(&mut dyn Engine, &Step) -> Result<(), Error>;

/// Times methods on steps.
pub struct Timer<'t, 'a, 'p> {
    engines: &'t mut [Box<dyn Engine + 'a>],
    steps: &'t [Step],
    counter: &'t mut Counter<'p>,
    /// Measured times.
    pub times: Milliseconds,
}

impl<'t, 'a, 'p> Timer<'t, 'a, 'p> {
    /// Creates a timer. `counter` counts each repetition on each step.
    pub fn new(
        engines: &'t mut [Box<dyn Engine + 'a>],
        steps: &'t [Step],
        counter: &'t mut Counter<'p>,
    ) -> Self {
        let times = vec![vec![None; engines.len()]; steps.len()];
        Self { engines, steps, counter, times }
    }

    /// Times the methods that take part on the chosen steps, block by block.
    pub fn time(
        &mut self,
        chosen: &[usize],
        takes_part: impl Fn(&Column) -> bool,
        queries: Queries<'_>,
    ) -> Result<(), Error> {
        for block in chosen.chunks(BLOCK) {
            let mut repetitions = vec![vec![Vec::new(); self.engines.len()]; block.len()];
            for _ in 0..REPETITIONS {
                for (column, engine) in self.engines.iter_mut().enumerate() {
                    for (repetitions, at) in repetitions.iter_mut().zip(block) {
                        if takes_part(&COLUMNS[column]) {
                            let step = &self.steps[*at];
                            let time = milliseconds(&mut || queries(engine.as_mut(), step))?;
                            repetitions[column].push(time);
                            self.counter.count()?;
                        }
                    }
                }
            }
            for (repetitions, at) in repetitions.into_iter().zip(block) {
                let time = |times: Vec<f64>| (!times.is_empty()).then(|| median(times));
                self.times[*at] = repetitions.into_iter().map(time).collect();
            }
        }
        Ok(())
    }
}
