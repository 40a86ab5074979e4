//! Constraint on the end of a step, for a contact or a point on the ground.

use glam::{DMat3, DVec3};

use super::friction_cone::is_mobile;
use crate::contacts::contact_constraint::ContactPoints;

/// Constraint on the end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correction {
    pub points: ContactPoints,
    /// Matrix from impulse to change of velocity.
    pub inverse_mass: DMat3,
    /// Change of velocity along the normal by a unit impulse along the normal.
    pub normal_inverse_mass: f64,
    /// The constraint along the normal is `n . w >= target`.
    pub target: f64,
    /// Mean velocity between the points in the step, without the correction w.
    pub slip: DVec3,
    pub friction: f64,
    /// Velocity at which the points of an impact separate after the step; None if they do not bounce.
    pub bounce: Option<f64>,
    /// Total impulse along the normal; never negative.
    pub normal_impulse: f64,
    /// Total impulse perpendicular to the normal.
    pub friction_impulse: DVec3,
    /// Impulse at the end of the step: see [`resting_velocities`](crate::resting_velocities).
    pub end_impulse: DVec3,
}

impl Correction {
    /// Whether an impulse along the normal moves the points.
    pub fn is_mobile(&self) -> bool {
        is_mobile(self.normal_inverse_mass, &self.inverse_mass)
    }

    /// Returns the impulse on the first body by which the end of the step is displaced.
    pub fn impulse(&self) -> DVec3 {
        self.points.normal * self.normal_impulse + self.friction_impulse
    }

    /// Returns the impulse on the first body in the whole step.
    pub fn total_impulse(&self) -> DVec3 {
        self.impulse() + self.end_impulse
    }
}
