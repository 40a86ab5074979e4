//! Velocities at the end of a step: points that contacts hold neither approach nor separate, and impacts bounce.
//!
//! The impulses of corrections act at the beginning of the step, and the forces of the step act after them. So the points of
//! a body at rest end the step with a velocity towards the ground: half of the velocity that its weight adds in a step.
//! Points whose gap recovers would be thrown off. Impulses of all contacts that bear a load stop both motions, and friction
//! stops sliding within Coulomb's cone. In the whole step contacts only push: an impulse at the end cancels at most the
//! impulse at the beginning. Modes have the weights of corrections, so that both impulses of a body at rest are equal, and
//! its modes stay at rest, too.
//!
//! Impacts bounce by Newton's law, after all contacts were stopped, with impulses that are at most as large as those that
//! stopped them. The bound is needed because Newton's law demands a velocity of each point. Where a part is wedged between
//! points with opposite normals, these velocities contradict each other, and without the bound impulses grow in each
//! iteration. For the same reason the positions at the end of the step do not bounce: staying in place satisfies all
//! contacts.

use glam::{DMat3, DVec3};
use pulp::{Simd, WithSimd};

use super::contact_rows::ContactRows;
use super::correction::Correction;
use super::correction_solver::CorrectionSolver;
use super::friction_cone::{is_mobile, limit_friction, stop_sliding};
use super::rigid_velocity::{RigidVelocity, modal_inverse_mass};
use crate::Body;
use crate::bodies::displacement::displacement;
use crate::contacts::contact::Contact;
use crate::contacts::contact_constraint::{ContactPoints, Side, Source};
use crate::contacts::ground_point::rest_position;
use crate::packed_rows::dispatch;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 50;

/// Iterations end when one changes velocities by less than this share of the first one's change.
const RELATIVE_TOLERANCE: f64 = 1e-3;

/// Contact that bears a load. Vectors are in axes of the world; for a contact within one body, in axes of the body.
struct Load {
    /// Number of the correction.
    correction: usize,
    points: ContactPoints,
    /// Matrix from impulse to change of velocity.
    inverse_mass: DMat3,
    friction: f64,
    /// Impulses at the beginning of the step.
    given_normal: f64,
    given_friction: DVec3,
    /// Velocity at which the points of an impact separate; None if they do not bounce.
    bounce: Option<f64>,
    /// Velocity between the points before the impulses.
    velocity: DVec3,
    /// Target velocity along the normal.
    target: f64,
    /// Minimum and maximum impulse along the normal at the end of the step.
    range: [f64; 2],
    /// Impulses at the end of the step.
    normal_impulse: f64,
    friction_impulse: DVec3,
}

impl CorrectionSolver {
    /// Stops the relative motion of all points that the corrections of this step hold apart.
    pub fn stop_contacts(&mut self, bodies: &mut [Body], contacts: &[Contact]) {
        let Self { list, rows, .. } = self;
        let is_loaded = |(_, one): &(usize, &Correction)| one.normal_impulse > 0.0;
        if !list.iter().enumerate().any(|one| is_loaded(&one)) {
            return;
        }
        let velocities: Vec<RigidVelocity> = bodies.iter().map(RigidVelocity::of).collect();
        rows.begin(velocities.iter().zip(&*bodies).map(|(rigid, body)| (rigid, &body.step_weights[..])));
        let corrections = list.iter().enumerate().filter(is_loaded);
        let mut loads: Vec<Load> = corrections
            .map(|(n, one)| {
                let load = Load::new(n, one, bodies, contacts, &velocities);
                rows.push::<3>(&load.points, bodies, contacts);
                load
            })
            .collect();
        dispatch(Stopping { loads: &mut loads, rows });
        let mut bounces = false;
        for load in &mut loads {
            let Some(speed) = load.bounce else { continue };
            let stopping = (load.given_normal + load.normal_impulse).max(0.0);
            (load.target, load.range) = (speed, [load.normal_impulse, load.normal_impulse + stopping]);
            bounces = true;
        }
        if bounces {
            dispatch(Stopping { loads: &mut loads, rows });
        }
        for load in &loads {
            let impulse = load.points.normal * load.normal_impulse + load.friction_impulse;
            list[load.correction].end_impulse = impulse;
            load.points.push(impulse, bodies, contacts, |weight| weight);
        }
    }
}

impl Load {
    /// Returns the contact of a correction in the bodies' current state.
    fn new(
        correction: usize,
        one: &Correction,
        bodies: &[Body],
        contacts: &[Contact],
        velocities: &[RigidVelocity],
    ) -> Self {
        let mut points = one.points;
        if !points.is_within() {
            let of_sides = points.sides().map(|Side { n, body, .. }| {
                let body = &bodies[body];
                let rest = match points.source {
                    Source::Vertex(vertex) => rest_position(body.shape(), vertex),
                    Source::Contact(contact) => contacts[contact as usize].rest[n],
                };
                body.point(rest, points.modes(n, body.shape(), contacts))
            });
            let (count, sum) = of_sides.fold((0.0, DVec3::ZERO), |(count, sum), x| (count + 1.0, sum + x));
            points.arms = [DVec3::ZERO; 2];
            for Side { n, body, .. } in points.sides() {
                points.arms[n] = sum / count - bodies[body].rigid.position;
            }
        }
        let (mut inverse_mass, mut velocity) = (DMat3::ZERO, DVec3::ZERO);
        for Side { n, body, sign } in points.sides() {
            let (rigid, body, arm) = (&velocities[body], &bodies[body], points.arms[n]);
            let modes = points.modes(n, body.shape(), contacts);
            let modal = displacement(modes, &body.v);
            if points.is_within() {
                inverse_mass += modal_inverse_mass(modes, &body.step_weights);
                velocity += modal;
            } else {
                inverse_mass += rigid.inverse_mass_at(arm, modes, &body.step_weights);
                velocity += rigid.of_point(arm, modal) * sign;
            }
        }
        Self {
            correction,
            points,
            inverse_mass,
            friction: one.friction,
            given_normal: one.normal_impulse,
            given_friction: one.friction_impulse,
            bounce: one.bounce,
            velocity,
            target: 0.0,
            range: [if one.bounce.is_some() { 0.0 } else { -one.normal_impulse }, f64::INFINITY],
            normal_impulse: 0.0,
            friction_impulse: DVec3::ZERO,
        }
    }
}

/// Changes the velocities at all contacts to their targets, as far as the impulses may. The rows have the numbers of the loads.
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
    /// Stops the motion at one contact, or cancels as much of its impulse as the other contacts allow. Returns the change of
    /// velocity.
    #[inline(always)]
    fn stop_contact<S: Simd>(&mut self, simd: S, n: usize) -> f64 {
        let (load, rows) = (&mut self.loads[n], &mut *self.rows);
        let Load { points: ContactPoints { normal, .. }, inverse_mass, friction, .. } = *load;
        let normal_inverse_mass = normal.dot(inverse_mass * normal);
        if !is_mobile(normal_inverse_mass, &inverse_mass) {
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
