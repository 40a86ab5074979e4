//! Phases of a step, its counts and its impulses.

use glam::DVec3;

/// Phases of a step, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Phase {
    /// Self-collision detection.
    SelfCollision,
    /// Detection of collisions between bodies.
    InterObject,
    /// Search for vertices in contact with the ground.
    Ground,
    /// Contact constraints and their impulses.
    Contacts,
    /// Integration of the motion.
    Dynamics,
    /// End of the step.
    Done,
}

/// Receives the start of each phase of a step, for example to measure times. `()` ignores all calls.
pub trait Observer {
    /// Called at the start of `phase`.
    fn enter(&mut self, phase: Phase);
}

impl Observer for () {
    fn enter(&mut self, _: Phase) {}
}

impl<F: FnMut(Phase)> Observer for F {
    fn enter(&mut self, phase: Phase) {
        self(phase);
    }
}

/// Counts of collisions and contacts at the start of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Number of bodies that collide with themselves.
    pub self_colliding: usize,
    /// Number of colliding triangle pairs within bodies.
    pub self_pairs: usize,
    /// Number of bodies whose q is outside the certificate of the root.
    pub root_failed: usize,
    /// Number of colliding pairs of bodies.
    pub colliding_bodies: usize,
    /// Number of colliding triangle pairs between bodies.
    pub inter_pairs: usize,
    /// Number of vertices in contact with the ground.
    pub ground: usize,
    /// Number of triangle contacts, colliding or within the skin.
    pub contacts: usize,
}

/// Impulse on a body in the last step; input of [`SoundBank`](crate::SoundBank).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Number of the body.
    pub body: usize,
    /// Vertices on which the impulse acts.
    pub vertices: [u32; 3],
    /// Share of each vertex.
    pub weights: [f64; 3],
    /// Force times time (mass unit times model unit per s), in axes of the rest pose.
    pub impulse: DVec3,
}
