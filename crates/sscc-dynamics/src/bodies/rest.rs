//! Rest of a body: for how long no point of it has moved, and whether it sleeps.

use glam::{DQuat, DVec3};

use super::displacement::displacement;
use crate::{RigidMotion, Shape};

/// A body that vibrates near its reference state has its vertices tested once in this number of steps.
const CHECK_STEPS: u64 = 16;

/// A body whose modes have moved by more than this multiple of the distance, summed over the modes, is not at rest.
const MAX_BEND: f64 = 16.0;

/// How long a body has been at rest, measured against a reference state.
#[derive(Clone, Debug)]
pub(crate) struct Rest {
    /// Whether the body sleeps: it does not move, and steps compute nothing for it.
    pub is_asleep: bool,
    /// Time for which the body has stayed near the reference state (s).
    pub time: f64,
    pub position: DVec3,
    pub orientation: DQuat,
    pub q: Vec<f64>,
}

impl Rest {
    /// Adds a step to the time, or makes the current state the reference if some point may have moved farther than `distance`
    /// from the reference state. Costs O(r), plus O(r) for each vertex where many modes move, each by little. `bend_bound`
    /// bounds the displacements of all vertices by a change of q.
    pub fn update(
        &mut self,
        shape: &Shape,
        rigid: &RigidMotion,
        q: &[f64],
        (step, distance): (f64, f64),
        bend_bound: impl Fn(&[f64]) -> f64,
    ) {
        let before = self.orientation;
        let before = if before.dot(rigid.orientation) < 0.0 { -before } else { before };
        // A rotation by the angle t moves a unit vector by at most 2 sin(t / 2); quaternions differ by 2 sin(t / 4).
        let turned = 2.0 * (rigid.orientation - before).length();
        let (mut reach, mut bent) = (shape.radius(), 0.0);
        for ((u, q), before) in shape.reach().iter().zip(q).zip(&self.q) {
            reach += u * q.abs();
            bent += u * (q - before).abs();
        }
        let moved = (rigid.position - self.position).length() + turned * reach;
        let is_due = ((self.time / step).round() as u64).is_multiple_of(CHECK_STEPS);
        let is_near = moved <= distance && bent <= MAX_BEND * distance;
        if moved + bent <= distance
            || (is_near && (!is_due || self.is_bent_within(shape, q, distance - moved, bend_bound)))
        {
            self.time += step;
            return;
        }
        self.time = 0.0;
        (self.position, self.orientation) = (rigid.position, rigid.orientation);
        self.q.copy_from_slice(q);
    }

    /// Whether the modes have moved all vertices by at most `distance` from the reference state. The sum of the largest
    /// displacements by each mode is a bound, but vibrations of many modes reach it at no vertex.
    fn is_bent_within(
        &self,
        shape: &Shape,
        q: &[f64],
        distance: f64,
        bend_bound: impl Fn(&[f64]) -> f64,
    ) -> bool {
        let modes = shape.model().modes();
        let change: Vec<f64> = q.iter().zip(&self.q).map(|(q, before)| q - before).collect();
        if bend_bound(&change) <= distance {
            return true;
        }
        let vertices = shape.model().mesh().rest_positions().len() as u32;
        (0..vertices).all(|v| displacement(modes.of_vertex(v), &change).length() <= distance)
    }
}
