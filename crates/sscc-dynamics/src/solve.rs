//! Solver for contact impulses: projected Gauss-Seidel with an energy budget for each body.
//!
//! A contact constraint is a spring with a damper that can only push, integrated implicitly, and Coulomb friction. The
//! solver visits one constraint after the other, several times. An impulse p changes the energy by exactly `p . (v +
//! v') / 2`, where v and v' are the relative velocities before and after it.
//!
//! The energy budget of a body is the energy that its contacts have dissipated so far. An impulse may add at most the
//! sum of the budgets of its bodies. Contacts therefore never add energy to that of the start, up to rounding, for
//! every stiffness and step. Budgets of bodies that take no part in a contact are not used.

use glam::{DMat3, DVec3};

use crate::body::Body;
use crate::contact::{Contact, Mobility, moved};

/// Number that stands for the ground in place of a body.
pub(crate) const GROUND: u32 = u32::MAX;

/// Origin of a contact constraint.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source {
    /// Contact of this vertex with the ground.
    Vertex(u32),
    /// Triangle contact with this number.
    Contact(u32),
}

/// Contact constraint of one step. Vectors are in axes of the world; for a contact within one body, in axes of the
/// body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub bodies: [u32; 2],
    pub source: Source,
    pub normal: DVec3,
    /// Vectors from the centres of mass to the common point on which impulses act.
    pub arms: [DVec3; 2],
    /// Compression of the spring: penetration depth beyond the skin; negative where the contact is open.
    pub depth: f64,
    pub mobility: [Mobility; 2],
    pub friction: f64,
    /// The impulse on the first body so far: along the normal, and across.
    pub pressure: f64,
    pub drag: DVec3,
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

/// Constants of a constraint in the solver.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Matrix from impulse to velocity change (inverse effective mass).
    response: DMat3,
    along: f64,
    softness: f64,
    /// The velocity at which the spring pushes apart.
    target: f64,
}

/// Velocities and inverse masses of a body while impulses act.
#[derive(Clone, Copy, Debug)]
struct Mover {
    velocity: DVec3,
    spin: DVec3,
    inverse_mass: f64,
    inverse_inertia: DMat3,
    rotation: DMat3,
}

/// Constants of all contacts in a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spring {
    /// Angular frequency (rad/s).
    pub rate: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Step (s).
    pub step: f64,
    /// Rounds at most.
    pub rounds: usize,
}

/// A round that changes velocities by less than this share of what the first one did is the last.
const SETTLED: f64 = 1e-3;

/// Two points of a body yield at least like this share of a free mass, that of the body.
const LEAST_MOBILITY: f64 = 1e-2;

#[derive(Clone, Debug, Default)]
pub(crate) struct Solver {
    pub touches: Vec<Touch>,
    rows: Vec<Row>,
    movers: Vec<Mover>,
    /// Touches of each body.
    counts: Vec<usize>,
}

impl Solver {
    /// Computes the impulses of all constraints and applies them to the bodies.
    pub fn solve(&mut self, bodies: &mut [Body<'_>], contacts: &[Contact], spring: &Spring) {
        if self.touches.is_empty() {
            return;
        }
        self.movers.clear();
        self.movers.extend(bodies.iter().map(Mover::of));
        self.counts.clear();
        self.counts.resize(bodies.len(), 0);
        for side in self.touches.iter().flat_map(Touch::sides) {
            self.counts[side.body] += 1;
        }
        self.rows.clear();
        for touch in &self.touches {
            let (mut quick, mut slow, mut count) = (DMat3::ZERO, DMat3::ZERO, 1);
            for Side { n, body, .. } in touch.sides() {
                let [a, b] =
                    self.movers[body].responses(touch.arms[n], &touch.mobility[n], touch.is_within());
                quick += a;
                slow += b;
                count = self.counts[body].max(count);
            }
            let mut row = Row::new(touch, quick, slow, spring, spring.implicit(count));
            if touch.is_within() {
                // Where hardly any mode moves the two apart, the impulse that would do so has no bound.
                row.softness += LEAST_MOBILITY / bodies[touch.bodies[0] as usize].shape().mass().mass;
            }
            self.rows.push(row);
        }
        let mut first = 0.0;
        for round in 0..spring.rounds {
            let mut largest = 0.0_f64;
            for n in 0..self.touches.len() {
                // To and fro.
                let n = if round % 2 == 0 { n } else { self.touches.len() - 1 - n };
                largest = largest.max(self.visit(n, bodies, contacts));
            }
            if round == 0 {
                first = largest;
            }
            if largest <= SETTLED * first {
                break;
            }
        }
    }

    /// Updates the impulse of one constraint. Returns the change of velocity along its normal.
    fn visit(&mut self, n: usize, bodies: &mut [Body<'_>], contacts: &[Contact]) -> f64 {
        let (row, touch) = (self.rows[n], self.touches[n]);
        let ledger: f64 = touch.sides().map(|side| bodies[side.body].ledger).sum();
        let v = self.velocity(&touch, bodies, contacts);
        let normal = touch.normal;
        let approach = v.dot(normal);
        let mut push = (row.target - approach - row.softness * touch.pressure) / (row.along + row.softness);
        push = push.max(-touch.pressure);
        // Work of the push: push (approach + along push / 2).
        if push * (approach + row.along * push / 2.0) > ledger {
            let most = ((approach * approach + 2.0 * row.along * ledger).sqrt() - approach) / row.along;
            push = if push > 0.0 { push.min(most) } else { 0.0 };
        }
        let mut impulse = normal * push;
        let after = v + row.response * impulse;
        let mut work = impulse.dot(v + after) / 2.0;
        let pressure = touch.pressure + push;
        // Friction: what would stop sliding along its direction, within the cone.
        let sliding = after - normal * normal.dot(after);
        let mut drag = touch.drag;
        if touch.friction > 0.0 {
            if let Some(way) = sliding.try_normalize() {
                drag -= way * (sliding.length() / way.dot(row.response * way));
            }
            drag = drag.clamp_length_max(touch.friction * pressure);
            let change = drag - touch.drag;
            let slid = after + row.response * change;
            let friction_work = change.dot(after + slid) / 2.0;
            if friction_work <= 0.0 || work + friction_work <= ledger {
                impulse += change;
                work += friction_work;
            } else {
                drag = touch.drag;
            }
        }
        // What is given comes from both as they have it, what is taken goes to both alike.
        let count = touch.sides().count() as f64;
        for Side { body, .. } in touch.sides() {
            let own = &mut bodies[body].ledger;
            let share = if work > 0.0 && ledger > 0.0 { *own / ledger } else { 1.0 / count };
            *own = (*own - work * share).max(0.0);
        }
        (self.touches[n].pressure, self.touches[n].drag) = (pressure, drag);
        self.act(&touch, impulse, bodies, contacts);
        push.abs() * row.along
    }

    /// The velocity of the first body at the touch, less that of the second.
    fn velocity(&self, touch: &Touch, bodies: &[Body<'_>], contacts: &[Contact]) -> DVec3 {
        let mut sum = DVec3::ZERO;
        for Side { n, body, sign } in touch.sides() {
            let mover = &self.movers[body];
            let body = &bodies[body];
            let deforming = moved(touch.modes(n, body, contacts), &body.v);
            sum += if touch.is_within() {
                deforming
            } else {
                (mover.velocity + mover.spin.cross(touch.arms[n]) + mover.rotation * deforming) * sign
            };
        }
        sum
    }

    fn act(&mut self, touch: &Touch, impulse: DVec3, bodies: &mut [Body<'_>], contacts: &[Contact]) {
        for Side { n, body, sign } in touch.sides() {
            let mover = &mut self.movers[body];
            let body = &mut bodies[body];
            let mut local = impulse;
            if !touch.is_within() {
                let impulse = impulse * sign;
                if body.is_free() {
                    let turn = touch.arms[n].cross(impulse);
                    mover.velocity += impulse * mover.inverse_mass;
                    mover.spin += mover.inverse_inertia * turn;
                    body.rigid.momentum += impulse;
                    body.rigid.angular_momentum += turn;
                }
                local = mover.rotation.transpose() * impulse;
            }
            body.was_pushed();
            let modes = touch.modes(n, body, contacts);
            body.v.iter_mut().zip(modes).for_each(|(v, u)| *v += u.dot(local));
        }
    }
}

impl Spring {
    /// Implicit share of the spring force when `count` constraints act on one body. The frequency of `count` springs
    /// together is higher by the square root of `count`. A share of 0 conserves energy but is unstable for long steps;
    /// a share of 1 is always stable but damps.
    fn implicit(&self, count: usize) -> f64 {
        let angle = self.rate * self.step;
        (angle * angle * count as f64).clamp(f64::EPSILON, 1.0)
    }
}

impl Touch {
    /// Whether both sides are of one body.
    pub fn is_within(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// Returns the bodies of the constraint, each once, without the ground.
    pub fn sides(&self) -> impl Iterator<Item = Side> + use<> {
        let (bodies, within) = (self.bodies, self.is_within());
        let counts = move |n: &usize| bodies[*n] != GROUND && (*n == 0 || !within);
        (0..2).filter(counts).map(move |n| Side { n, body: bodies[n] as usize, sign: [1.0, -1.0][n] })
    }

    fn modes<'s>(&self, n: usize, body: &Body<'s>, contacts: &'s [Contact]) -> &'s [DVec3] {
        match self.source {
            Source::Vertex(v) => body.shape().model().modes().of_vertex(v),
            Source::Contact(contact) => &contacts[contact as usize].modes[n],
        }
    }
}

impl Row {
    fn new(touch: &Touch, quick: DMat3, slow: DMat3, spring: &Spring, implicit: f64) -> Self {
        let normal = touch.normal;
        // Per mass: stiffness w^2, damping 2 zeta w.
        let Spring { rate, damping, step, .. } = *spring;
        let divisor = 2.0 * damping + implicit * rate * step;
        Self {
            response: quick,
            along: normal.dot(quick * normal),
            softness: normal.dot(slow * normal) / (step * rate * divisor),
            target: touch.depth * rate / divisor,
        }
    }
}

impl Mover {
    fn of(body: &Body<'_>) -> Self {
        let rotation = body.rotation();
        if !body.is_free() {
            let (velocity, spin, inverse_inertia) = (DVec3::ZERO, DVec3::ZERO, DMat3::ZERO);
            return Self { velocity, spin, inverse_mass: 0.0, inverse_inertia, rotation };
        }
        let inverse_mass = 1.0 / body.shape().mass().mass;
        Self {
            velocity: body.rigid.momentum * inverse_mass,
            spin: body.rigid.angular_velocity(),
            inverse_mass,
            inverse_inertia: rotation * body.rigid.inverse_inertia() * rotation.transpose(),
            rotation,
        }
    }

    /// Returns the matrices from impulse to velocity at a point: with all modes, and with slow modes only.
    fn responses(&self, arm: DVec3, mobility: &Mobility, within: bool) -> [DMat3; 2] {
        if within {
            return [mobility.quick, mobility.slow];
        }
        let cross = DMat3::from_cols(
            DVec3::new(0.0, arm.z, -arm.y),
            DVec3::new(-arm.z, 0.0, arm.x),
            DVec3::new(arm.y, -arm.x, 0.0),
        );
        let rigid =
            DMat3::from_diagonal(DVec3::splat(self.inverse_mass)) - cross * self.inverse_inertia * cross;
        let turned = |x: DMat3| rigid + self.rotation * x * self.rotation.transpose();
        [turned(mobility.quick), turned(mobility.slow)]
    }
}
