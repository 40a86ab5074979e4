//! Buffers of a step of a world.

use sscc::{Impact, Pair};

use crate::body::Body;

/// Buffers that all steps share, so that they allocate nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepBuffers {
    /// Whether each body moves in the current round of this step.
    pub moves: Vec<bool>,
    /// Energy of each body before its correction; None where there is none.
    pub energies: Vec<Option<f64>>,
    /// Impacts of the current round, with their bodies.
    pub impacts: Vec<([usize; 2], Impact)>,
    /// Pairs of triangles near impacts, with their bodies.
    pub near: Vec<([usize; 2], Pair)>,
    /// Bodies whose near pairs this step has found.
    pub gathered: Vec<[usize; 2]>,
    /// Whether each island can sleep, at the number of its first body.
    pub can_sleep: Vec<bool>,
    /// Whether the ground or a held body supports each island.
    pub is_supported: Vec<bool>,
}

impl StepBuffers {
    /// Begins a step, in which all bodies that are awake move.
    pub fn begin(&mut self, bodies: &[Body<'_>]) {
        self.moves.clear();
        self.moves.extend(bodies.iter().map(|body| !body.is_asleep()));
        self.gathered.clear();
    }
}
