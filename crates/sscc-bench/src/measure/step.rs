//! One step of all bodies.

/// One step of all bodies: from each `q_t0[i]` to `q_t1[i]`. Discrete queries are those at the start of the step.
#[derive(Clone, Debug)]
pub struct Step {
    /// q of each body one step earlier; only for the first step of a block of consecutive steps.
    pub before: Option<Vec<Vec<f64>>>,
    /// q of each body at the start of the step.
    pub q_t0: Vec<Vec<f64>>,
    /// q of each body at the end of the step.
    pub q_t1: Vec<Vec<f64>>,
}
