//! What a step of a world consists of, and what it tells.

use glam::DVec3;

/// The parts of a step, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Phase {
    /// Finding collisions within bodies.
    SelfCollision,
    /// Finding collisions between bodies.
    InterObject,
    /// Finding what touches the ground.
    Ground,
    /// Contacts and their impulses.
    Penalty,
    /// Moving on.
    Dynamics,
    /// The step is over.
    Done,
}

/// Is told when a phase of a step begins: for clocks, which this crate does not have. `()` ignores it.
pub trait Observer {
    /// What comes next.
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

/// What a step found when it began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Bodies that collide with themselves.
    pub self_colliding: usize,
    /// Pairs of triangles of one body each that collide.
    pub self_pairs: usize,
    /// Bodies for which the root's certificate alone proves nothing.
    pub root_failed: usize,
    /// Pairs of bodies that collide.
    pub colliding_bodies: usize,
    /// Pairs of their triangles that collide.
    pub inter_pairs: usize,
    /// Vertices that touch the ground.
    pub ground: usize,
    /// Pairs of triangles in contact, colliding or held apart.
    pub contacts: usize,
}

/// An impulse on a body in the last step: what makes it sound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// The body.
    pub body: usize,
    /// The vertices on which it acted ...
    pub vertices: [u32; 3],
    /// ... and the share of each.
    pub weights: [f64; 3],
    /// Force times time, in axes of the rest pose.
    pub impulse: DVec3,
}
