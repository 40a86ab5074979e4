//! Solver for corrections: the smallest change of the end of a step at which all contacts hold.
//!
//! The unknown is the change w of the mean velocity of each body in the step (rigid motion and modes). The end of the
//! step is displaced by `step * w`, and the velocity there changes by w. The metric is that of mass, inertia and modes, in
//! which fast modes weigh more: an impulse at the beginning of a step of Newmark's method moves them by as much less. A
//! contact bounds the gap at the end of the step, which is a linear function of w, from below. Friction opposes the
//! tangential displacement in the step, within Coulomb's cone. The solution is that of projected Gauss-Seidel, which
//! begins with the impulses of the last step.

use glam::{DMat3, DVec3};

use crate::Ground;
use crate::body::Body;
use crate::change::Change;
use crate::contact::Contact;
use crate::contact_constraint::{GROUND, Side, Source, sides};
use crate::contact_solver::{RigidVelocity, modal_inverse_mass};
use crate::displacement::displacement;
use crate::friction_cone::{limit_friction, stop_sliding};
use crate::ground_contacts::GroundContacts;
use crate::ground_point::{GroundPoint, rest_position};
use crate::rigid_contacts::RigidContacts;

/// Constraint on the end of a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Correction {
    pub bodies: [u32; 2],
    pub source: Source,
    pub normal: DVec3,
    arms: [DVec3; 2],
    /// Matrix from impulse to change of velocity.
    inverse_mass: DMat3,
    /// Change of velocity along the normal by a unit impulse along the normal.
    normal_inverse_mass: f64,
    /// The constraint along the normal is `n . w >= target`.
    target: f64,
    /// Mean velocity between the points in the step, without w.
    slip: DVec3,
    pub friction: f64,
    /// Velocity at which the points of an impact part after the step; None if they do not bounce.
    pub bounce: Option<f64>,
    /// Total impulse along the normal; never negative.
    pub normal_impulse: f64,
    /// Total impulse perpendicular to the normal.
    pub friction_impulse: DVec3,
    /// Impulse at the end of the step: see [`resting_velocities`](crate::resting_velocities).
    pub end_impulse: DVec3,
}

impl Correction {
    /// Returns the impulse on the first body by which the end of the step is displaced.
    fn impulse(&self) -> DVec3 {
        self.normal * self.normal_impulse + self.friction_impulse
    }

    /// Returns the impulse on the first body in the whole step.
    pub fn total_impulse(&self) -> DVec3 {
        self.impulse() + self.end_impulse
    }

    /// Whether both points belong to one body. Their impulses then change its modes alone.
    pub fn is_within(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }
}

/// Corrections of a step, and the buffers to find them.
#[derive(Clone, Debug, Default)]
pub(crate) struct CorrectionSolver {
    pub list: Vec<Correction>,
    active: Vec<u32>,
    masses: Vec<RigidVelocity>,
    /// Change of each body, and that of the modes of all bodies, one after the other.
    changes: Vec<Change>,
    modes: Vec<f64>,
    /// First mode of each body.
    first_mode: Vec<usize>,
    /// The changes with which bodies were moved last.
    applied: (Vec<Change>, Vec<f64>),
}

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 200;

/// Iterations end when one changes displacements by less than this share of the gap at rest.
const TOLERANCE: f64 = 1e-3;

impl CorrectionSolver {
    /// Begins a step.
    pub fn begin(&mut self, bodies: &[Body<'_>]) {
        self.list.clear();
        self.masses.clear();
        self.masses.extend(bodies.iter().map(|body| RigidVelocity::at(body, &body.start.rigid)));
        self.changes.clear();
        self.changes.resize(bodies.len(), Change::default());
        self.first_mode.clear();
        let mut modes = 0;
        for body in bodies {
            self.first_mode.push(modes);
            modes += body.q.len();
        }
        self.modes.clear();
        self.modes.resize(modes, 0.0);
        self.applied.0.clone_from(&self.changes);
        self.applied.1.clone_from(&self.modes);
    }

    /// Makes the list of constraints of the ground and of contacts, in the bodies' current state.
    pub fn gather(
        &mut self,
        bodies: &[Body<'_>],
        ground: (&[GroundContacts], Option<Ground>),
        contacts: &[Contact],
        rigid: &RigidContacts,
        friction: f64,
    ) {
        self.list.clear();
        if let (all, Some(ground)) = ground {
            for (n, (body, contacts)) in bodies.iter().zip(all).enumerate() {
                for point in contacts.points.iter().filter(|_| !body.is_asleep()) {
                    self.add_ground(n, point, body, &ground, rigid);
                }
            }
        }
        for (n, contact) in contacts.iter().enumerate() {
            let both = contact.bodies.map(|body| &bodies[body as usize]);
            if !contact.is_rigid_constraint() || both.iter().all(|body| body.is_asleep()) {
                continue;
            }
            if contact.is_within() {
                self.add_within(n, contact, both[0], rigid, friction);
            } else {
                self.add_rigid(n, contact, both, rigid, friction);
            }
        }
    }

    fn add_ground(
        &mut self,
        number: usize,
        point: &GroundPoint,
        body: &Body<'_>,
        ground: &Ground,
        rigid: &RigidContacts,
    ) {
        let GroundPoint { vertex, arm, gap, min_gap, normal_impulse, friction_impulse } = *point;
        let (rest, modes) =
            (rest_position(body.shape(), vertex), body.shape().model().modes().of_vertex(vertex));
        let start = body.start.rigid.position + arm;
        let normal = ground.normal;
        let inverse_mass = self.masses[number].inverse_mass_at(arm, modes, &body.step_weights);
        let applied = self.velocity(number, arm, modes, &self.applied.0, &self.applied.1);
        let slip = (body.point(rest, modes) - start) / rigid.step - applied;
        let trial = normal.dot(body.trial.point(rest, modes) - start) / rigid.step;
        let approach = -normal.dot(body.start.rigid.velocity_at(arm));
        self.list.push(Correction {
            bodies: [number as u32, GROUND],
            source: Source::Vertex(vertex),
            normal,
            arms: [arm, DVec3::ZERO],
            inverse_mass,
            normal_inverse_mass: normal.dot(inverse_mass * normal),
            target: (min_gap - gap) / rigid.step - normal.dot(slip),
            slip,
            friction: ground.friction,
            bounce: rigid.bounce(approach.min(-trial)),
            normal_impulse,
            friction_impulse,
            end_impulse: DVec3::ZERO,
        });
    }

    fn add_rigid(
        &mut self,
        number: usize,
        contact: &Contact,
        both: [&Body<'_>; 2],
        rigid: &RigidContacts,
        friction: f64,
    ) {
        let mut inverse_mass = DMat3::ZERO;
        let mut applied = DVec3::ZERO;
        let mut now = [DVec3::ZERO; 2];
        for (n, sign) in [(0, 1.0), (1, -1.0)] {
            let (body, modes, arm) = (both[n], &contact.modes[n], contact.arms[n]);
            let number = contact.bodies[n] as usize;
            inverse_mass += self.masses[number].inverse_mass_at(arm, modes, &body.step_weights);
            let (changes, modal) = (&self.applied.0, &self.applied.1);
            applied += self.velocity(number, arm, modes, changes, modal) * sign;
            now[n] = body.point(contact.rest[n], modes);
        }
        let normal = contact.world_normal;
        let slip = (now[0] - now[1] - contact.between) / rigid.step - applied;
        let trial = contact.between(both.map(|body| &body.trial)) - contact.between;
        let approach = -normal.dot(trial) / rigid.step;
        let friction_impulse = contact.friction_impulse;
        self.list.push(Correction {
            bodies: contact.bodies,
            source: Source::Contact(number as u32),
            normal,
            arms: contact.arms,
            inverse_mass,
            normal_inverse_mass: normal.dot(inverse_mass * normal),
            target: (contact.min_gap - contact.gap) / rigid.step - normal.dot(slip),
            slip,
            friction,
            bounce: rigid.bounce(contact.approach(both).min(approach)),
            normal_impulse: contact.normal_impulse,
            friction_impulse: friction_impulse - normal * normal.dot(friction_impulse),
            end_impulse: DVec3::ZERO,
        });
    }

    /// Adds the constraint of a contact within a body. Its vectors are in axes of the body.
    fn add_within(
        &mut self,
        number: usize,
        contact: &Contact,
        body: &Body<'_>,
        rigid: &RigidContacts,
        friction: f64,
    ) {
        let (modes, normal) = (&contact.modes[0], contact.normal);
        let inverse_mass = modal_inverse_mass(modes, &body.step_weights);
        let own = contact.bodies[0] as usize;
        let applied = displacement(modes, &self.applied.1[self.first_mode[own]..][..modes.len()]);
        let now = contact.rest[0] - contact.rest[1] + displacement(modes, &body.q);
        let slip = (now - contact.between) / rigid.step - applied;
        let friction_impulse = contact.friction_impulse;
        self.list.push(Correction {
            bodies: contact.bodies,
            source: Source::Contact(number as u32),
            normal,
            arms: [DVec3::ZERO; 2],
            inverse_mass,
            normal_inverse_mass: normal.dot(inverse_mass * normal),
            target: (contact.min_gap - contact.gap) / rigid.step - normal.dot(slip),
            slip,
            friction,
            bounce: None,
            normal_impulse: contact.normal_impulse,
            friction_impulse: friction_impulse - normal * normal.dot(friction_impulse),
            end_impulse: DVec3::ZERO,
        });
    }

    /// Solves the constraints that act on a body of `among`, which must contain whole islands, and moves these bodies.
    pub fn solve(
        &mut self,
        bodies: &mut [Body<'_>],
        contacts: &[Contact],
        rigid: &RigidContacts,
        among: &[bool],
    ) {
        self.active.clear();
        let is_active = |n: &u32| {
            let one = &self.list[*n as usize];
            one.normal_inverse_mass > 0.0 && sides(one.bodies).any(|side| among[side.body])
        };
        self.active.extend((0..self.list.len() as u32).filter(is_active));
        for (n, body) in bodies.iter().enumerate().filter(|(n, _)| among[*n]) {
            self.changes[n] = Change::default();
            self.modes[self.first_mode[n]..][..body.q.len()].fill(0.0);
        }
        for active in 0..self.active.len() {
            let one = self.list[self.active[active] as usize];
            let impulse = one.impulse();
            if impulse != DVec3::ZERO {
                self.apply(&one, impulse, bodies, contacts);
            }
        }
        let tolerance = TOLERANCE * rigid.rest_gap / rigid.step;
        for iteration in 0..MAX_ITERATIONS {
            let mut max_change = 0.0_f64;
            for n in 0..self.active.len() {
                // Symmetric Gauss-Seidel: the order alternates.
                let n = if iteration % 2 == 0 { n } else { self.active.len() - 1 - n };
                max_change = max_change.max(self.update(self.active[n] as usize, bodies, contacts));
            }
            if max_change <= tolerance {
                break;
            }
        }
        for (n, body) in bodies.iter_mut().enumerate().filter(|(n, _)| among[*n]) {
            let modes = &self.modes[self.first_mode[n]..][..body.q.len()];
            body.correct(&self.changes[n], modes, rigid.step);
        }
        self.applied.0.clone_from(&self.changes);
        self.applied.1.clone_from(&self.modes);
    }

    /// Updates the impulse of one constraint. Returns the change of velocity between its points.
    fn update(&mut self, n: usize, bodies: &[Body<'_>], contacts: &[Contact]) -> f64 {
        let one = self.list[n];
        let normal = one.normal;
        let mut w = DVec3::ZERO;
        for Side { n, body, sign } in sides(one.bodies) {
            let modes = one.source.modes(n, &bodies[body], contacts);
            w += if one.is_within() {
                displacement(modes, &self.modes[self.first_mode[body]..][..modes.len()])
            } else {
                self.velocity(body, one.arms[n], modes, &self.changes, &self.modes) * sign
            };
        }
        let change = (one.target - normal.dot(w)) / one.normal_inverse_mass;
        let change = change.max(-one.normal_impulse);
        let normal_impulse = one.normal_impulse + change;
        let mut impulse = normal * change;
        let mut friction_impulse = one.friction_impulse;
        if one.friction > 0.0 && (normal_impulse > 0.0 || friction_impulse != DVec3::ZERO) {
            let after = one.slip + w + one.inverse_mass * impulse;
            let sliding = after - normal * normal.dot(after);
            friction_impulse += stop_sliding(sliding, &one.inverse_mass);
            friction_impulse =
                limit_friction(friction_impulse, one.friction, normal, normal_impulse, &one.inverse_mass);
            impulse += friction_impulse - one.friction_impulse;
        }
        if impulse == DVec3::ZERO {
            return 0.0;
        }
        (self.list[n].normal_impulse, self.list[n].friction_impulse) = (normal_impulse, friction_impulse);
        self.apply(&one, impulse, bodies, contacts);
        (one.inverse_mass * impulse).length()
    }

    /// Returns the change of velocity of a point of a body.
    fn velocity(&self, body: usize, arm: DVec3, modes: &[DVec3], changes: &[Change], modal: &[f64]) -> DVec3 {
        let change = &changes[body];
        let own = &modal[self.first_mode[body]..][..modes.len()];
        change.velocity
            + change.angular_velocity.cross(arm)
            + self.masses[body].rotation * displacement(modes, own)
    }

    /// Adds an impulse to the changes of the bodies.
    fn apply(&mut self, one: &Correction, impulse: DVec3, bodies: &[Body<'_>], contacts: &[Contact]) {
        for Side { n, body, sign } in sides(one.bodies) {
            let (mass, change, impulse) = (&self.masses[body], &mut self.changes[body], impulse * sign);
            if bodies[body].is_free() && !one.is_within() {
                let angular_impulse = one.arms[n].cross(impulse);
                change.impulse += impulse;
                change.angular_impulse += angular_impulse;
                change.velocity += impulse * mass.inverse_mass;
                change.angular_velocity += mass.inverse_inertia * angular_impulse;
            }
            let local = if one.is_within() { impulse } else { mass.rotation.transpose() * impulse };
            let modes = one.source.modes(n, &bodies[body], contacts);
            let own = &mut self.modes[self.first_mode[body]..][..modes.len()];
            for ((w, u), weight) in own.iter_mut().zip(modes).zip(&bodies[body].step_weights) {
                *w += weight * u.dot(local);
            }
        }
    }
}
