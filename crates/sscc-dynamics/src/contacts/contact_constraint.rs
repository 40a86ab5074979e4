//! Contact constraint of one step, which only pushes its points apart, with Coulomb friction.

use glam::DVec3;

use super::contact::{Contact, ModalInverseMass};
use crate::{Body, Shape};

/// Number that stands for the ground in a constraint's list of bodies.
pub(crate) const GROUND: u32 = u32::MAX;

/// Origin of a contact constraint.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// Contact of this vertex with the ground.
    Vertex(u32),
    /// Triangle contact with this number.
    Contact(u32),
}

/// Where the impulses of a contact constraint act. Vectors are in axes of the world; for a contact within one body, in axes of
/// the body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactPoints {
    /// Numbers of the two bodies; equal for a contact within one body.
    pub bodies: [u32; 2],
    pub source: Source,
    /// Unit normal; pushes the first body away from the second.
    pub normal: DVec3,
    /// Vectors from the centres of mass to the common point on which impulses act; zeros for a contact within one body.
    pub arms: [DVec3; 2],
}

/// Constraint of a soft contact in one step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactConstraint {
    pub points: ContactPoints,
    /// Length by which the spring is compressed: penetration depth beyond the skin; negative where the contact is open.
    pub compression: f64,
    /// Modal inverse masses of the two points.
    pub modal_inverse_mass: [ModalInverseMass; 2],
    /// Coulomb's coefficient of friction.
    pub friction: f64,
    /// Accumulated impulse on the first body along the normal; never negative.
    pub normal_impulse: f64,
    /// Accumulated impulse on the first body perpendicular to the normal.
    pub friction_impulse: DVec3,
}

/// Body that takes part in a constraint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// 0 for the first body, 1 for the second.
    pub n: usize,
    pub body: usize,
    /// Sign of the impulse on this body.
    pub sign: f64,
}

impl ContactConstraint {
    /// Returns the impulse on the first body.
    pub fn impulse(&self) -> DVec3 {
        self.points.normal * self.normal_impulse + self.friction_impulse
    }
}

impl ContactPoints {
    /// Whether both points belong to one body. Their impulses then change only its modes.
    pub fn is_within(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// Returns the bodies of the constraint, each once, without the ground.
    pub fn sides(&self) -> impl Iterator<Item = Side> + use<> {
        let bodies = self.bodies;
        let counts = move |n: &usize| bodies[*n] != GROUND && (*n == 0 || bodies[0] != bodies[1]);
        (0..2).filter(counts).map(move |n| Side { n, body: bodies[n] as usize, sign: [1.0, -1.0][n] })
    }

    /// Returns the displacements of the point of body n of the constraint by each mode (r vectors, axes of the body).
    pub fn modes<'s>(&self, n: usize, shape: &'s Shape, contacts: &'s [Contact]) -> &'s [DVec3] {
        match self.source {
            Source::Vertex(v) => shape.model().modes().of_vertex(v),
            Source::Contact(contact) => &contacts[contact as usize].modes[n],
        }
    }

    /// Adds an impulse on the first body, and its reaction, to momenta and modal velocities. `inverse_mass` maps an entry of
    /// [`Body::step_weights`] to the inverse mass of the mode.
    pub fn push(
        &self,
        impulse: DVec3,
        bodies: &mut [Body],
        contacts: &[Contact],
        inverse_mass: impl Fn(f64) -> f64,
    ) {
        for Side { n, body, sign } in self.sides() {
            let body = &mut bodies[body];
            let mut local = impulse;
            if !self.is_within() {
                let impulse = impulse * sign;
                if body.is_free() {
                    body.rigid.momentum += impulse;
                    body.rigid.angular_momentum += self.arms[n].cross(impulse);
                }
                local = body.rotation().transpose() * impulse;
            }
            let modes = self.modes(n, &body.shape, contacts);
            for ((v, u), weight) in body.v.iter_mut().zip(modes).zip(&body.step_weights) {
                *v += inverse_mass(*weight) * u.dot(local);
            }
        }
    }
}
