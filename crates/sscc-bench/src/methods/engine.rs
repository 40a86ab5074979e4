//! Interface of the methods that benches compare.

use sscc::{Error, Impact, Pair, Query};

/// A method for queries on one model. A call does all work of a query, including moving vertices and refitting.
pub trait Engine {
    /// Returns the pairs that collide at q, sorted.
    ///
    /// # Errors
    /// When q has the wrong length, has an entry that is not finite, or moves vertices out of range.
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error>;

    /// Returns the pairs that collide during the motion from q_t0 to q_t1, sorted, each with its time of impact.
    ///
    /// # Errors
    /// When q_t0 or q_t1 has the wrong length, has an entry that is not finite, or moves vertices out of range.
    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error>;
}

impl Engine for Query {
    fn discrete(&mut self, q: &[f64]) -> Result<&[Pair], Error> {
        self.discrete(q)
    }

    fn continuous(&mut self, q_t0: &[f64], q_t1: &[f64]) -> Result<&[Impact], Error> {
        self.continuous(q_t0, q_t1)
    }
}
