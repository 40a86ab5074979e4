//! Velocities and inverse masses of a body, by which an impulse changes its motion.

use glam::{DMat3, DVec3};

use crate::contacts::contact::ModalInverseMass;
use crate::{Body, RigidMotion};

/// Velocities and inverse masses of a body, updated with each impulse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidVelocity {
    velocity: DVec3,
    angular_velocity: DVec3,
    pub inverse_mass: f64,
    pub inverse_inertia: DMat3,
    pub rotation: DMat3,
}

impl RigidVelocity {
    pub fn of(body: &Body) -> Self {
        Self::at(body, &body.rigid)
    }

    /// Returns the velocities and inverse masses of a body with this motion.
    pub fn at(body: &Body, rigid: &RigidMotion) -> Self {
        let rotation = DMat3::from_quat(rigid.orientation);
        if !body.is_free() {
            return Self {
                velocity: DVec3::ZERO,
                angular_velocity: DVec3::ZERO,
                inverse_mass: 0.0,
                inverse_inertia: DMat3::ZERO,
                rotation,
            };
        }
        let inverse_mass = 1.0 / body.shape().mass().mass;
        Self {
            velocity: rigid.momentum * inverse_mass,
            angular_velocity: rigid.angular_velocity(),
            inverse_mass,
            inverse_inertia: rotation * rigid.inverse_inertia() * rotation.transpose(),
            rotation,
        }
    }

    /// Returns the velocity of a point that moves with `modal` in axes of the body.
    pub fn of_point(&self, arm: DVec3, modal: DVec3) -> DVec3 {
        self.velocity + self.angular_velocity.cross(arm) + self.rotation * modal
    }

    /// Adds the change by an impulse.
    #[cfg(test)]
    pub fn push(&mut self, impulse: DVec3, arm: DVec3) {
        self.velocity += impulse * self.inverse_mass;
        self.angular_velocity += self.inverse_inertia * arm.cross(impulse);
    }

    /// Returns the matrices from impulse to velocity at a point: with all modes, and with slow modes only.
    pub fn inverse_masses(&self, arm: DVec3, modal: &ModalInverseMass, within: bool) -> [DMat3; 2] {
        if within {
            return [modal.all_modes, modal.slow_modes];
        }
        let rigid = self.rigid_inverse_mass(arm);
        let total = |x: DMat3| rigid + self.rotation * x * self.rotation.transpose();
        [total(modal.all_modes), total(modal.slow_modes)]
    }

    /// Returns the matrix from impulse to velocity at a point that does not deform.
    fn rigid_inverse_mass(&self, arm: DVec3) -> DMat3 {
        let cross = DMat3::from_cols(
            DVec3::new(0.0, arm.z, -arm.y),
            DVec3::new(-arm.z, 0.0, arm.x),
            DVec3::new(arm.y, -arm.x, 0.0),
        );
        DMat3::from_diagonal(DVec3::splat(self.inverse_mass)) - cross * self.inverse_inertia * cross
    }

    /// Returns the matrix from impulse to velocity at a point with these modes, each of which has a weight.
    pub fn inverse_mass_at(&self, arm: DVec3, modes: &[DVec3], weights: &[f64]) -> DMat3 {
        let modal = modal_inverse_mass(modes, weights);
        self.rigid_inverse_mass(arm) + self.rotation * modal * self.rotation.transpose()
    }
}

/// Returns the matrix from impulse to velocity due to modes, each of which has a weight (axes of the body).
pub(crate) fn modal_inverse_mass(modes: &[DVec3], weights: &[f64]) -> DMat3 {
    let mut sum = DMat3::ZERO;
    for (u, weight) in modes.iter().zip(weights) {
        let x = *u * *weight;
        sum += DMat3::from_cols(*u * x.x, *u * x.y, *u * x.z);
    }
    sum
}
