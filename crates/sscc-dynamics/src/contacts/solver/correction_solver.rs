//! Solver for corrections: the smallest change of the end of a step at which all contacts hold.
//!
//! The unknown is the change w of the mean velocity of each body in the step (rigid motion and modes). The end of the
//! step is displaced by `step * w`, and the velocity there changes by w. The metric is that of mass, inertia and modes, in
//! which fast modes weigh more: an impulse at the beginning of a step of Newmark's method moves them by as much less. A
//! contact bounds the gap at the end of the step, which is a linear function of w, from below. Friction opposes the
//! tangential displacement in the step, within Coulomb's cone. The solution is that of projected Gauss-Seidel, which
//! begins with the impulses of the last step.
//!
//! Contacts whose points no impulse along the normal moves, up to rounding, have no impulse. Where other motions make such
//! points meet, the bodies move only a part of their motion (`step_limiter.rs`).

use glam::{DMat3, DVec3};

use super::contact_rows::ContactRows;
use super::correction::Correction;
use super::gauss_seidel::{Active, GaussSeidel};
use super::rigid_velocity::{RigidVelocity, modal_inverse_mass};
use crate::bodies::body_set::BodySet;
use crate::bodies::change::Change;
use crate::bodies::displacement::displacement;
use crate::contacts::contact::Contact;
use crate::contacts::contact_constraint::{ContactPoints, GROUND, Side, Source};
use crate::contacts::contact_laws::ContactLaws;
use crate::contacts::ground_contacts::GroundContacts;
use crate::contacts::ground_point::{GroundPoint, rest_position};
use crate::contacts::islands::Islands;
use crate::packed_rows::dispatch;
use crate::{Body, Ground};

/// Corrections of a step, and the buffers to find them.
#[derive(Clone, Debug, Default)]
pub(crate) struct CorrectionSolver {
    pub list: Vec<Correction>,
    active: Vec<Active>,
    islands: Islands,
    /// Rows of the constraints. [`resting_velocities`](crate::resting_velocities) uses them, too.
    pub rows: ContactRows,
    masses: Vec<RigidVelocity>,
    /// Change of each body, and the changes of the modes of all bodies, one after the other.
    changes: Vec<Change>,
    modes: Vec<f64>,
    /// First mode of each body.
    first_mode: Vec<usize>,
    /// The changes by which bodies were moved last.
    applied: (Vec<Change>, Vec<f64>),
}

/// Motion of the two points of a contact.
struct PointMotion {
    /// Matrix from impulse to change of velocity.
    inverse_mass: DMat3,
    /// Change of the velocity between the points that is already part of the current state.
    applied: DVec3,
    /// Vector between the points in the current state.
    now: DVec3,
}

/// Iterations end when one changes displacements by less than this share of the gap at rest.
const TOLERANCE: f64 = 1e-3;

impl CorrectionSolver {
    /// Begins a step.
    pub fn begin(&mut self, bodies: &[Body]) {
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
        bodies: &[Body],
        ground: &[GroundContacts],
        contacts: &[Contact],
        laws: &ContactLaws,
    ) {
        self.list.clear();
        if let Some(plane) = &laws.ground {
            for (n, (body, contacts)) in bodies.iter().zip(ground).enumerate() {
                for point in contacts.points.iter().filter(|_| !body.is_asleep()) {
                    self.add_ground(n, point, body, plane, laws);
                }
            }
        }
        for (n, contact) in contacts.iter().enumerate() {
            let both = contact.bodies.map(|body| &bodies[body as usize]);
            if !contact.is_rigid_constraint() || both.iter().all(|body| body.is_asleep()) {
                continue;
            }
            self.add_rigid(n, contact, both, laws);
        }
        // These are not solved, so an impulse of the last step must not remain.
        for one in self.list.iter_mut().filter(|one| !one.is_mobile()) {
            (one.normal_impulse, one.friction_impulse) = (0.0, DVec3::ZERO);
        }
    }

    fn add_ground(
        &mut self,
        number: usize,
        point: &GroundPoint,
        body: &Body,
        ground: &Ground,
        laws: &ContactLaws,
    ) {
        let GroundPoint { vertex, arm, gap, min_gap, normal_impulse, friction_impulse } = *point;
        let (rest, modes) =
            (rest_position(body.shape(), vertex), body.shape().model().modes().of_vertex(vertex));
        let start = body.start.rigid.position + arm;
        let normal = ground.normal;
        let inverse_mass = self.masses[number].inverse_mass_at(arm, modes, &body.step_weights);
        let applied = self.velocity(number, arm, modes, &self.applied.0, &self.applied.1);
        let slip = (body.point(rest, modes) - start) / laws.step - applied;
        let trial = normal.dot(body.trial.point(rest, modes) - start) / laws.step;
        let approach = -normal.dot(body.start.rigid.velocity_at(arm));
        self.list.push(Correction {
            points: ContactPoints {
                bodies: [number as u32, GROUND],
                source: Source::Vertex(vertex),
                normal,
                arms: [arm, DVec3::ZERO],
            },
            inverse_mass,
            normal_inverse_mass: normal.dot(inverse_mass * normal),
            target: (min_gap - gap) / laws.step - normal.dot(slip),
            slip,
            friction: ground.friction,
            bounce: laws.bounce(approach.min(-trial)),
            normal_impulse,
            friction_impulse,
            end_impulse: DVec3::ZERO,
        });
    }

    /// Adds the constraint of a rigid contact. For a contact within a body, vectors are in axes of the body.
    fn add_rigid(&mut self, number: usize, contact: &Contact, both: [&Body; 2], laws: &ContactLaws) {
        let Contact { bodies, min_gap, gap, normal_impulse, friction_impulse, .. } = *contact;
        let (normal, arms, bounce, motion) = if contact.is_within() {
            (contact.normal, [DVec3::ZERO; 2], None, self.motion_within(contact, both[0]))
        } else {
            let trial = contact.between(both.map(|body| &body.trial)) - contact.between;
            let approach = -contact.world_normal.dot(trial) / laws.step;
            let bounce = laws.bounce(contact.approach(both).min(approach));
            (contact.world_normal, contact.arms, bounce, self.motion_between(contact, both))
        };
        let PointMotion { inverse_mass, applied, now } = motion;
        let slip = (now - contact.between) / laws.step - applied;
        self.list.push(Correction {
            points: ContactPoints { bodies, source: Source::Contact(number as u32), normal, arms },
            inverse_mass,
            normal_inverse_mass: normal.dot(inverse_mass * normal),
            target: (min_gap - gap) / laws.step - normal.dot(slip),
            slip,
            friction: laws.friction,
            bounce,
            normal_impulse,
            friction_impulse: friction_impulse - normal * normal.dot(friction_impulse),
            end_impulse: DVec3::ZERO,
        });
    }

    /// Returns how the points of a contact of two bodies move.
    fn motion_between(&self, contact: &Contact, both: [&Body; 2]) -> PointMotion {
        let (mut inverse_mass, mut applied, mut now) = (DMat3::ZERO, DVec3::ZERO, [DVec3::ZERO; 2]);
        for (n, sign) in [(0, 1.0), (1, -1.0)] {
            let (body, modes, arm) = (both[n], &contact.modes[n], contact.arms[n]);
            let number = contact.bodies[n] as usize;
            inverse_mass += self.masses[number].inverse_mass_at(arm, modes, &body.step_weights);
            applied += self.velocity(number, arm, modes, &self.applied.0, &self.applied.1) * sign;
            now[n] = body.point(contact.rest[n], modes);
        }
        PointMotion { inverse_mass, applied, now: now[0] - now[1] }
    }

    /// Returns how the points of a contact within a body move, in axes of the body.
    fn motion_within(&self, contact: &Contact, body: &Body) -> PointMotion {
        let (modes, first) = (&contact.modes[0], self.first_mode[contact.bodies[0] as usize]);
        PointMotion {
            inverse_mass: modal_inverse_mass(modes, &body.step_weights),
            applied: displacement(modes, &self.applied.1[first..][..modes.len()]),
            now: contact.rest[0] - contact.rest[1] + displacement(modes, &body.q),
        }
    }

    /// Solves the constraints that act on a body of `among`, which must contain whole islands, and moves these bodies.
    pub fn solve(&mut self, bodies: &mut [Body], contacts: &[Contact], laws: &ContactLaws, among: &BodySet) {
        self.gather_islands(bodies, contacts, among);
        let tolerance = TOLERANCE * laws.rest_gap / laws.step;
        let (active, rows, list) = (&self.active, &mut self.rows, &mut self.list[..]);
        let mut first = 0;
        for island in active.chunk_by(|a, b| a.island == b.island) {
            dispatch(GaussSeidel { list, island, first, rows, tolerance });
            first += island.len();
        }
        for (n, body) in bodies.iter().enumerate().filter(|(n, _)| among.contains(*n)) {
            self.changes[n] = Change::default();
            self.modes[self.first_mode[n]..][..body.q.len()].fill(0.0);
        }
        for active in 0..self.active.len() {
            let one = self.list[self.active[active].number as usize];
            let impulse = one.impulse();
            if impulse != DVec3::ZERO {
                self.apply(&one, impulse, bodies, contacts);
            }
        }
        for (n, body) in bodies.iter_mut().enumerate().filter(|(n, _)| among.contains(*n)) {
            let modes = &self.modes[self.first_mode[n]..][..body.q.len()];
            body.correct(&self.changes[n], modes, laws.step);
        }
        self.applied.0.clone_from(&self.changes);
        self.applied.1.clone_from(&self.modes);
    }

    /// Gathers the constraints that act on a body of `among`, island by island, with their rows.
    fn gather_islands(&mut self, bodies: &[Body], contacts: &[Contact], among: &BodySet) {
        let Self { list, active, islands, rows, masses, .. } = self;
        let is_active =
            |one: &Correction| one.is_mobile() && one.points.sides().any(|side| among.contains(side.body));
        islands.reset(bodies.len());
        for one in list.iter().filter(|one| is_active(one) && one.points.bodies[1] != GROUND) {
            islands.join(one.points.bodies[0] as usize, one.points.bodies[1] as usize);
        }
        active.clear();
        let numbered = (0_u32..).zip(&*list).filter(|(_, one)| is_active(one));
        active.extend(
            numbered
                .map(|(number, one)| Active { island: islands.of(one.points.bodies[0] as usize), number }),
        );
        active.sort_unstable_by_key(|one| (one.island, one.number));
        rows.begin(masses.iter().zip(bodies).map(|(mass, body)| (mass, &body.step_weights[..])));
        for one in active.iter().map(|active| &list[active.number as usize]) {
            rows.push::<3>(&one.points, bodies, contacts);
        }
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
    fn apply(&mut self, one: &Correction, impulse: DVec3, bodies: &[Body], contacts: &[Contact]) {
        for Side { n, body, sign } in one.points.sides() {
            let (mass, change, impulse) = (&self.masses[body], &mut self.changes[body], impulse * sign);
            if bodies[body].is_free() && !one.points.is_within() {
                let angular_impulse = one.points.arms[n].cross(impulse);
                change.impulse += impulse;
                change.angular_impulse += angular_impulse;
                change.velocity += impulse * mass.inverse_mass;
                change.angular_velocity += mass.inverse_inertia * angular_impulse;
            }
            let local = if one.points.is_within() { impulse } else { mass.rotation.transpose() * impulse };
            let modes = one.points.modes(n, bodies[body].shape(), contacts);
            let own = &mut self.modes[self.first_mode[body]..][..modes.len()];
            for ((w, u), weight) in own.iter_mut().zip(modes).zip(&bodies[body].step_weights) {
                *w += weight * u.dot(local);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::contacts::nearest_triangles::Nearest;
    use crate::test_shapes::tetrahedron;
    use crate::{Start, WorldOptions};

    /// The only mode of two held bodies moves them along the face in contact, and along its normal only by rounding.
    #[test]
    fn contacts_have_no_impulse_where_no_mode_moves_their_points_apart() {
        let shape = tetrahedron(vec![DVec3::new(1.0, -2.0, 0.0); 4], &[1.0]);
        let options = WorldOptions::default();
        let laws = ContactLaws::new(&options, 0.1);
        let mut both = BodySet::default();
        both.set([true; 2].into_iter());
        let mut moved_by_rounding = 0;
        for n in 0..40 {
            let t = f64::from(n);
            let orientation =
                DQuat::from_scaled_axis(DVec3::new(0.3 + 0.1 * t, 0.7 - 0.05 * t, 0.2 * t)).normalize();
            let mut bodies = [DVec3::new(-0.2, -0.2, 1.01), DVec3::ZERO].map(|offset| {
                let position = Some(orientation * offset);
                let start = Start { is_free: false, position, orientation, ..Start::default() };
                Body::new(&shape, &start, &options, None).unwrap()
            });
            // The lowest face of the first body is above the highest vertex of the second.
            let corners = [bodies[0].start_corners(0, false), bodies[1].start_corners(1, false)];
            let (normal, vertex) = (orientation * DVec3::Z, corners[1][2]);
            let nearest = Nearest { points: [vertex + normal * 0.01, vertex], normal, features: 1 };
            let mut contact = Contact::default();
            contact.begin_rigid([0, 1], (0, 1), [&bodies[0], &bodies[1]], &corners, &nearest, false);
            contact.min_gap = contact.gap + 0.01;
            contact.normal_impulse = 1.0;
            let contacts = [contact];
            let mut solver = CorrectionSolver::default();
            solver.begin(&bodies);
            solver.gather(&bodies, &[], &contacts, &laws);
            solver.solve(&mut bodies, &contacts, &laws, &both);
            let [one] = &solver.list[..] else { panic!("{} constraints", solver.list.len()) };
            assert!(one.target > 0.0);
            assert_eq!(one.impulse(), DVec3::ZERO, "{n}");
            assert!(bodies.iter().all(|body| body.q == [0.0]), "{n}");
            moved_by_rounding += usize::from(one.normal_inverse_mass > 0.0);
        }
        assert!(moved_by_rounding > 4, "{moved_by_rounding}");
    }
}
