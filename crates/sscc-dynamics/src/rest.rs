//! Rest of a body: for how long no point of it has moved, and whether it sleeps.

use glam::{DQuat, DVec3};

use crate::{RigidMotion, Shape};

/// How long a body has been at rest, measured against a reference state.
#[derive(Clone, Debug)]
pub(crate) struct Rest {
    /// Whether the body sleeps: it does not move, and no step computes anything of it.
    pub is_asleep: bool,
    /// Time for which the body has stayed near the reference state (s).
    pub time: f64,
    pub position: DVec3,
    pub orientation: DQuat,
    pub q: Vec<f64>,
}

impl Rest {
    /// Adds a step to the time, or, if some point may have moved farther than `distance` from the reference state, makes
    /// the current state the reference.
    pub fn update(&mut self, shape: &Shape, rigid: &RigidMotion, q: &[f64], step: f64, distance: f64) {
        let before = self.orientation;
        let before = if before.dot(rigid.orientation) < 0.0 { -before } else { before };
        // A rotation by the angle t moves a unit vector by at most 2 sin(t / 2); quaternions differ by 2 sin(t / 4).
        let turned = 2.0 * (rigid.orientation - before).length();
        let (mut reach, mut bent) = (shape.radius(), 0.0);
        for ((u, q), before) in shape.reach().iter().zip(q).zip(&self.q) {
            reach += u * q.abs();
            bent += u * (q - before).abs();
        }
        let moved = (rigid.position - self.position).length() + turned * reach + bent;
        if moved <= distance {
            self.time += step;
            return;
        }
        self.time = 0.0;
        (self.position, self.orientation) = (rigid.position, rigid.orientation);
        self.q.copy_from_slice(q);
    }
}
