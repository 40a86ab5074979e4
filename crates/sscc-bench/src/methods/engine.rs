//! A method at work.

use sscc::{Error, Impact, Pair, Query};

/// A method at work: everything that it needs for an answer is done within the call.
pub trait Engine {
    /// The pairs that collide at q, sorted.
    ///
    /// # Errors
    /// When q has the wrong length, or is out of range.
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error>;

    /// The pairs that meet on the straight line from one q to another, sorted, each with its time of impact.
    ///
    /// # Errors
    /// When a q has the wrong length, or is out of range.
    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error>;
}

impl Engine for Query<'_> {
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.discrete(q)
    }

    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.continuous(q_t0, q_t1)
    }
}
