//! Buffers of a step of a world.

use sscc::{Impact, Pair};

use crate::body::Body;

/// Buffers that all steps share, so that they allocate nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepBuffers {
    /// Whether each body moves in the current round of this step.
    pub moves: Vec<bool>,
    /// Whether each body sinks into the ground in the current round.
    pub sinks: Vec<bool>,
    /// Energies of each body at the beginning of the step and before its correction; None where there is none.
    pub energies: Vec<Option<[f64; 2]>>,
    /// Energy that the recovery of all gaps of each island costs, and the budgets of its bodies, at the number of its first
    /// body.
    pub recovery: Vec<[f64; 2]>,
    /// Sums over each island, at the number of its first body: potential energy at the end of the step less energy budgets,
    /// energy at the beginning and at the end without contacts, and the size of these.
    pub excess: Vec<[f64; 4]>,
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
    pub fn begin(&mut self, bodies: &[Body]) {
        self.moves.clear();
        self.moves.extend(bodies.iter().map(|body| !body.is_asleep()));
        self.sinks.clear();
        self.sinks.resize(bodies.len(), false);
        self.gathered.clear();
    }
}
