//! One step of all bodies.

/// One step of all bodies: from each `q_t0[i]` to `q_t1[i]`. Discrete queries are those at its start.
#[derive(Clone, Debug)]
pub struct Step {
    /// Where the bodies were a step before, at the first step of a block of consecutive ones.
    pub before: Option<Vec<Vec<f64>>>,
    /// The bodies at the start of the step.
    pub q_t0: Vec<Vec<f64>>,
    /// The bodies at its end.
    pub q_t1: Vec<Vec<f64>>,
}
