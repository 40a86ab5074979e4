//! Velocities at the end of a step: points that contacts hold neither approach nor part, and impacts bounce.
//!
//! The impulses of corrections act at the beginning of the step, and the forces of the step act after them. So the points
//! of a body at rest end the step with a velocity towards the ground, half of what its weight adds in a step; and points
//! whose gap recovers would be thrown off. Impulses of all contacts that bear a load stop both, and friction the sliding
//! within Coulomb's cone. In the whole step contacts only push: an impulse at the end takes back at most the one at the
//! beginning. Modes have the weights of corrections, so that both impulses of a body at rest are equal, and its modes at
//! rest, too.
//!
//! Impacts bounce by Newton's law, after all contacts were stopped, with impulses that are at most as large as those that
//! stopped them. The bound is needed because Newton's law demands a velocity of each point: where a part is wedged between
//! points with opposite normals, these velocities contradict each other, and without it impulses grow in each iteration. For
//! the same reason the positions at the end of the step do not bounce: staying in place satisfies all contacts.

use glam::{DMat3, DVec3};

use crate::World;
use crate::contact_constraint::{Side, Source, sides};
use crate::contact_solver::{RigidVelocity, modal_inverse_mass};
use crate::correction::Correction;
use crate::displacement::displacement;
use crate::friction_cone::{limit_friction, stop_sliding};
use crate::ground_point::rest_position;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 50;

/// Iterations end when one changes velocities by less than this share of the first one's change.
const RELATIVE_TOLERANCE: f64 = 1e-3;

/// Contact that bears a load. Vectors are in axes of the world; for a contact within one body, in axes of the body.
struct Load {
    /// Number of the correction.
    correction: usize,
    bodies: [u32; 2],
    source: Source,
    normal: DVec3,
    /// Vectors from the centres of mass to the common point.
    arms: [DVec3; 2],
    /// Matrix from impulse to change of velocity.
    inverse_mass: DMat3,
    friction: f64,
    /// Impulses at the beginning of the step.
    given_normal: f64,
    given_friction: DVec3,
    /// Velocity at which the points of an impact part; None if they do not bounce.
    bounce: Option<f64>,
    /// Velocity along the normal that the impulses aim at.
    target: f64,
    /// Minimum and maximum impulse along the normal at the end of the step.
    range: [f64; 2],
    /// Impulses at the end of the step.
    normal_impulse: f64,
    friction_impulse: DVec3,
}

impl World<'_> {
    /// Stops the relative motion of all points that the corrections of this step hold apart.
    pub(crate) fn stop_contacts(&mut self) {
        let is_loaded = |(_, one): &(usize, &Correction)| one.normal_impulse > 0.0;
        if !self.corrections.list.iter().enumerate().any(|one| is_loaded(&one)) {
            return;
        }
        let mut velocities: Vec<RigidVelocity> = self.bodies.iter().map(RigidVelocity::of).collect();
        let corrections = self.corrections.list.iter().enumerate().filter(is_loaded);
        let mut loads: Vec<Load> = corrections.map(|(n, one)| self.load(n, one, &velocities)).collect();
        self.stop_all(&mut loads, &mut velocities);
        let mut bounces = false;
        for load in &mut loads {
            let Some(speed) = load.bounce else { continue };
            let stopping = (load.given_normal + load.normal_impulse).max(0.0);
            (load.target, load.range) = (speed, [load.normal_impulse, load.normal_impulse + stopping]);
            bounces = true;
        }
        if bounces {
            self.stop_all(&mut loads, &mut velocities);
        }
        for load in &loads {
            self.corrections.list[load.correction].end_impulse =
                load.normal * load.normal_impulse + load.friction_impulse;
        }
    }

    /// Gives the points of all contacts the velocities that they aim at, as far as their impulses can.
    fn stop_all(&mut self, loads: &mut [Load], velocities: &mut [RigidVelocity]) {
        let mut first_change = 0.0;
        for iteration in 0..MAX_ITERATIONS {
            let mut max_change = 0.0_f64;
            for load in &mut *loads {
                max_change = max_change.max(self.stop_contact(load, velocities));
            }
            if iteration == 0 {
                first_change = max_change;
            }
            if max_change <= RELATIVE_TOLERANCE * first_change {
                break;
            }
        }
    }

    /// Returns the contact of a correction in the bodies' current state.
    fn load(&self, correction: usize, one: &Correction, velocities: &[RigidVelocity]) -> Load {
        let Correction { bodies, source, normal, friction, .. } = *one;
        let contacts = &self.contacts.list;
        let is_within = one.is_within();
        let mut load = Load {
            correction,
            bodies,
            source,
            normal,
            arms: [DVec3::ZERO; 2],
            inverse_mass: DMat3::ZERO,
            friction,
            given_normal: one.normal_impulse,
            given_friction: one.friction_impulse,
            bounce: one.bounce,
            target: 0.0,
            range: [if one.bounce.is_some() { 0.0 } else { -one.normal_impulse }, f64::INFINITY],
            normal_impulse: 0.0,
            friction_impulse: DVec3::ZERO,
        };
        if !is_within {
            let points = sides(bodies).map(|Side { n, body, .. }| {
                let body = &self.bodies[body];
                let rest = match source {
                    Source::Vertex(vertex) => rest_position(body.shape(), vertex),
                    Source::Contact(contact) => contacts[contact as usize].rest[n],
                };
                body.point(rest, source.modes(n, body, contacts))
            });
            let (count, sum) = points.fold((0.0, DVec3::ZERO), |(count, sum), x| (count + 1.0, sum + x));
            for Side { n, body, .. } in sides(bodies) {
                load.arms[n] = sum / count - self.bodies[body].rigid.position;
            }
        }
        for Side { n, body, .. } in sides(bodies) {
            let (rigid, body) = (&velocities[body], &self.bodies[body]);
            let modes = source.modes(n, body, contacts);
            load.inverse_mass += if is_within {
                modal_inverse_mass(modes, &body.step_weights)
            } else {
                rigid.inverse_mass_at(load.arms[n], modes, &body.step_weights)
            };
        }
        load
    }

    /// Stops the motion at one contact, or takes back as much of its impulse as the others allow. Returns the change of
    /// velocity.
    fn stop_contact(&mut self, load: &mut Load, velocities: &mut [RigidVelocity]) -> f64 {
        let Load { bodies, source, normal, arms, inverse_mass, friction, .. } = *load;
        let normal_inverse_mass = normal.dot(inverse_mass * normal);
        if normal_inverse_mass <= 0.0 {
            return 0.0;
        }
        let (is_within, contacts) = (bodies[0] == bodies[1], &self.contacts.list);
        let mut v = DVec3::ZERO;
        for Side { n, body, sign } in sides(bodies) {
            let (rigid, body) = (&velocities[body], &self.bodies[body]);
            let modal = displacement(source.modes(n, body, contacts), &body.v);
            v += if is_within { modal } else { rigid.of_point(arms[n], modal) * sign };
        }
        let [least, most] = load.range;
        let before = load.normal_impulse;
        let wanted = before + (load.target - normal.dot(v)) / normal_inverse_mass;
        load.normal_impulse = wanted.max(least).min(most);
        let mut impulse = normal * (load.normal_impulse - before);
        let after = v + inverse_mass * impulse;
        let sliding = after - normal * normal.dot(after);
        let mut friction_impulse = load.friction_impulse + stop_sliding(sliding, &inverse_mass);
        let (total, total_normal) =
            (load.given_friction + friction_impulse, load.given_normal + load.normal_impulse);
        friction_impulse =
            limit_friction(total, friction, normal, total_normal, &inverse_mass) - load.given_friction;
        impulse += friction_impulse - load.friction_impulse;
        load.friction_impulse = friction_impulse;
        for Side { n, body, sign } in sides(bodies) {
            let (rigid, body) = (&mut velocities[body], &mut self.bodies[body]);
            let mut local = impulse;
            if !is_within {
                let impulse = impulse * sign;
                if body.is_free() {
                    rigid.push(impulse, arms[n]);
                    body.rigid.momentum += impulse;
                    body.rigid.angular_momentum += arms[n].cross(impulse);
                }
                local = rigid.rotation.transpose() * impulse;
            }
            let modes = source.modes(n, body, contacts);
            for ((v, u), weight) in body.v.iter_mut().zip(modes).zip(&body.step_weights) {
                *v += weight * u.dot(local);
            }
        }
        (inverse_mass * impulse).length()
    }
}
