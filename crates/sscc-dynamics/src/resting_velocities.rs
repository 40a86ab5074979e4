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
use pulp::{Simd, WithSimd};

use crate::World;
use crate::contact_constraint::{Side, Source, sides};
use crate::contact_rows::{ContactRows, RowPoint};
use crate::correction::Correction;
use crate::displacement::displacement;
use crate::friction_cone::{limit_friction, stop_sliding};
use crate::ground_point::rest_position;
use crate::packed_rows::dispatch;
use crate::rigid_velocity::{RigidVelocity, modal_inverse_mass};

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
    /// Velocity between the points before the impulses.
    velocity: DVec3,
    /// Velocity along the normal that the impulses aim at.
    target: f64,
    /// Minimum and maximum impulse along the normal at the end of the step.
    range: [f64; 2],
    /// Impulses at the end of the step.
    normal_impulse: f64,
    friction_impulse: DVec3,
}

impl World {
    /// Stops the relative motion of all points that the corrections of this step hold apart.
    pub(crate) fn stop_contacts(&mut self) {
        let is_loaded = |(_, one): &(usize, &Correction)| one.normal_impulse > 0.0;
        if !self.corrections.list.iter().enumerate().any(|one| is_loaded(&one)) {
            return;
        }
        let velocities: Vec<RigidVelocity> = self.bodies.iter().map(RigidVelocity::of).collect();
        let mut rows = std::mem::take(&mut self.corrections.rows);
        rows.begin(velocities.iter().zip(&self.bodies).map(|(rigid, body)| (rigid, &body.step_weights[..])));
        let corrections = self.corrections.list.iter().enumerate().filter(is_loaded);
        let mut loads: Vec<Load> =
            corrections.map(|(n, one)| self.load(n, one, &velocities, &mut rows)).collect();
        dispatch(Stopping { loads: &mut loads, rows: &mut rows });
        let mut bounces = false;
        for load in &mut loads {
            let Some(speed) = load.bounce else { continue };
            let stopping = (load.given_normal + load.normal_impulse).max(0.0);
            (load.target, load.range) = (speed, [load.normal_impulse, load.normal_impulse + stopping]);
            bounces = true;
        }
        if bounces {
            dispatch(Stopping { loads: &mut loads, rows: &mut rows });
        }
        self.corrections.rows = rows;
        for load in &loads {
            let impulse = load.normal * load.normal_impulse + load.friction_impulse;
            self.corrections.list[load.correction].end_impulse = impulse;
            self.push_apart(load, impulse, &velocities);
        }
    }

    /// Adds an impulse of a contact to the momenta and modal velocities of its bodies.
    fn push_apart(&mut self, load: &Load, impulse: DVec3, velocities: &[RigidVelocity]) {
        let is_within = load.bodies[0] == load.bodies[1];
        for Side { n, body, sign } in sides(load.bodies) {
            let (rigid, body) = (&velocities[body], &mut self.bodies[body]);
            let mut local = impulse;
            if !is_within {
                let impulse = impulse * sign;
                if body.is_free() {
                    body.rigid.momentum += impulse;
                    body.rigid.angular_momentum += load.arms[n].cross(impulse);
                }
                local = rigid.rotation.transpose() * impulse;
            }
            let modes = load.source.modes(n, &body.shape, &self.contacts.list);
            for ((v, u), weight) in body.v.iter_mut().zip(modes).zip(&body.step_weights) {
                *v += weight * u.dot(local);
            }
        }
    }

    /// Returns the contact of a correction in the bodies' current state, and adds its rows.
    fn load(
        &self,
        correction: usize,
        one: &Correction,
        velocities: &[RigidVelocity],
        rows: &mut ContactRows,
    ) -> Load {
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
            velocity: DVec3::ZERO,
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
                body.point(rest, source.modes(n, &body.shape, contacts))
            });
            let (count, sum) = points.fold((0.0, DVec3::ZERO), |(count, sum), x| (count + 1.0, sum + x));
            for Side { n, body, .. } in sides(bodies) {
                load.arms[n] = sum / count - self.bodies[body].rigid.position;
            }
        }
        for Side { n, body, sign } in sides(bodies) {
            let (rigid, body) = (&velocities[body], &self.bodies[body]);
            let modes = source.modes(n, &body.shape, contacts);
            let modal = displacement(modes, &body.v);
            if is_within {
                load.inverse_mass += modal_inverse_mass(modes, &body.step_weights);
                load.velocity += modal;
            } else {
                load.inverse_mass += rigid.inverse_mass_at(load.arms[n], modes, &body.step_weights);
                load.velocity += rigid.of_point(load.arms[n], modal) * sign;
            }
        }
        let points = sides(bodies).map(|Side { n, body, sign }| RowPoint {
            body,
            sign,
            arm: (!is_within).then_some(load.arms[n]),
            modes: source.modes(n, self.bodies[body].shape(), contacts),
        });
        rows.push(normal, points);
        load
    }
}

/// Gives the points of all contacts the velocities that they aim at, as far as their impulses can. The rows have the numbers of
/// the loads.
struct Stopping<'s> {
    loads: &'s mut [Load],
    rows: &'s mut ContactRows,
}

impl WithSimd for Stopping<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let mut first_change = 0.0;
        for iteration in 0..MAX_ITERATIONS {
            let mut max_change = 0.0_f64;
            for n in 0..self.loads.len() {
                max_change = max_change.max(self.stop_contact(simd, n));
            }
            if iteration == 0 {
                first_change = max_change;
            }
            if max_change <= RELATIVE_TOLERANCE * first_change {
                break;
            }
        }
    }
}

impl Stopping<'_> {
    /// Stops the motion at one contact, or takes back as much of its impulse as the others allow. Returns the change of
    /// velocity.
    #[inline(always)]
    fn stop_contact<S: Simd>(&mut self, simd: S, n: usize) -> f64 {
        let (load, rows) = (&mut self.loads[n], &mut *self.rows);
        let Load { normal, inverse_mass, friction, .. } = *load;
        let normal_inverse_mass = normal.dot(inverse_mass * normal);
        if normal_inverse_mass <= 0.0 {
            return 0.0;
        }
        let axes = rows.axes(n);
        let (along, [second, third]) = (rows.along_normal(simd, n), rows.across(simd, n));
        let v = load.velocity + (axes[0] * along + axes[1] * second + axes[2] * third);
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
        rows.push_along_axes(simd, n, axes.map(|axis| axis.dot(impulse)));
        (inverse_mass * impulse).length()
    }
}
