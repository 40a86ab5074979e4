//! World of bodies, and its time step: detection, contacts, integration.

use glam::DVec3;
use rayon::prelude::*;

use crate::body::Body;
use crate::body_collisions::BodyCollisions;
use crate::contact_constraint::{GROUND, Source};
use crate::contact_set::ContactSet;
use crate::contact_solver::{ContactSolver, Spring};
use crate::correction_solver::CorrectionSolver;
use crate::error::first_error;
use crate::ground_contacts::{GroundContacts, GroundOptions};
use crate::implicit_step::NewmarkBuffers;
use crate::islands::Islands;
use crate::rigid_contacts::RigidContacts;
use crate::root_constraint::constrain_to_root;
use crate::step_buffers::StepBuffers;
use crate::{
    BodyPairs, Counts, DynamicsError, Impulse, Observer, Obstacle, Phase, Response, Shape, Start,
    WorldOptions,
};

/// Bodies with their ground, contacts and options. The same steps give the same bits in every run and for any number of
/// threads.
pub struct World {
    pub(crate) options: WorldOptions,
    pub(crate) bodies: Vec<Body>,
    /// Contacts of each body with the ground.
    pub(crate) ground_contacts: Vec<GroundContacts>,
    pub(crate) body_collisions: BodyCollisions,
    pub(crate) contacts: ContactSet,
    pub(crate) rigid_contacts: RigidContacts,
    pub(crate) solver: ContactSolver,
    pub(crate) corrections: CorrectionSolver,
    pub(crate) islands: Islands,
    pub(crate) buffers: StepBuffers,
    /// Number of contacts at the beginning of this step; the list is sorted up to here.
    pub(crate) sorted_contacts: usize,
    /// Number of bodies that moved only a share of their way in this step.
    pub(crate) shortened_bodies: usize,
    /// Buffers of the integration of a single body.
    pub(crate) newmark: NewmarkBuffers,
    start: StartEnergy,
    pub(crate) step: u64,
    pub(crate) impulses: Vec<Impulse>,
}

/// Total energies of all bodies at the start. They bound the kinetic energy of later steps.
#[derive(Clone, Copy, Debug, Default)]
struct StartEnergy {
    energy: f64,
    potential: f64,
}

/// A motion diverges when its kinetic energy exceeds the available energy by this factor.
const MAX_ENERGY_RATIO: f64 = 4.0;

/// Bound of the rounding errors of a difference of potential energies, as a share of these. A body that returns to its first
/// height has no available energy.
const ENERGY_ROUNDING: f64 = 1e-9;

/// Rate at which preloads adapt, as a share of the angular frequency of contacts. Resting bodies are held after a few
/// seconds, and impacts hardly change.
const PRELOAD_ADAPTATION: f64 = 1.0 / 300.0;

impl World {
    /// Creates a world without bodies.
    ///
    /// # Errors
    /// When an option is outside its range.
    pub fn new(options: WorldOptions) -> Result<Self, DynamicsError> {
        options.check()?;
        Ok(Self {
            options,
            bodies: Vec::new(),
            ground_contacts: Vec::new(),
            body_collisions: BodyCollisions::default(),
            contacts: ContactSet::default(),
            rigid_contacts: RigidContacts::new(&options, 0.0),
            solver: ContactSolver::default(),
            corrections: CorrectionSolver::default(),
            islands: Islands::default(),
            buffers: StepBuffers::default(),
            sorted_contacts: 0,
            shortened_bodies: 0,
            newmark: NewmarkBuffers::default(),
            start: StartEnergy::default(),
            step: 0,
            impulses: Vec::new(),
        })
    }

    /// Adds a body and returns its number. Bodies of one shape share its certificates.
    ///
    /// # Errors
    /// When the initial state is invalid: see [`Start`].
    pub fn add(&mut self, shape: &Shape, start: &Start) -> Result<usize, DynamicsError> {
        let same_shape = self.bodies.iter().find(|body| body.shape().is_same(shape));
        let body = Body::new(shape, start, &self.options, same_shape)?;
        self.start.energy += body.energy();
        self.start.potential += body.potential(self.options.gravity);
        self.bodies.push(body);
        self.ground_contacts.push(GroundContacts::default());
        self.rigid_contacts = RigidContacts::new(&self.options, self.skin());
        Ok(self.bodies.len() - 1)
    }

    /// Returns the options of the world.
    pub fn options(&self) -> &WorldOptions {
        &self.options
    }

    /// Returns all bodies, in the order of their numbers.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Returns the number of completed steps.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// Returns the simulated time (s).
    pub fn time(&self) -> f64 {
        self.step as f64 * self.options.step
    }

    /// Returns kinetic, elastic and potential energy of all bodies.
    pub fn energy(&self) -> f64 {
        self.bodies.iter().map(|body| body.energy() + body.potential(self.options.gravity)).sum()
    }

    /// Returns the energy that contacts have dissipated (heat), less the energy that they have returned; never
    /// negative.
    pub fn dissipated(&self) -> f64 {
        self.bodies.iter().map(|body| body.energy_budget).sum()
    }

    /// Returns the impulses of the last step, in the order of contacts.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// Returns the colliding bodies and their triangle pairs at the start of the last step.
    pub fn inter_pairs(&self) -> impl Iterator<Item = BodyPairs<'_>> {
        self.body_collisions.colliding()
    }

    /// Returns the number of bodies that moved only a share of their way in the last step, because no correction kept them
    /// apart, or because the corrected end had too much elastic energy.
    pub fn shortened_bodies(&self) -> usize {
        self.shortened_bodies
    }

    /// Returns the skin: the distance below which surfaces are in contact (model unit).
    pub fn skin(&self) -> f64 {
        let smallest = || self.bodies.iter().map(|body| body.shape().radius()).fold(f64::INFINITY, f64::min);
        self.options.contact.skin.unwrap_or_else(|| 1e-3 * smallest())
    }

    /// Checks that no body penetrates another one, the ground or itself. Self-collisions are refused only with
    /// [`Response::Contact`] and [`Response::Penalty`]: contacts would push on surfaces that touch at rest in every step.
    ///
    /// # Errors
    /// When a body penetrates; the error names the first one.
    pub fn check_start(&mut self) -> Result<(), DynamicsError> {
        let refused =
            |body, what, count, unit| Err(DynamicsError::Interpenetration { body, what, count, unit });
        if matches!(self.options.response, Response::Contact | Response::Penalty) {
            self.detect_self_collisions()?;
            if let Some(body) = self.bodies.iter().position(|body| !body.pairs.is_empty()) {
                return refused(body, Obstacle::Itself, self.bodies[body].pairs.len(), "pairs of triangles");
            }
        }
        self.body_collisions.update(&mut self.bodies)?;
        if let Some(BodyPairs { bodies: [a, b], pairs }) = self.body_collisions.colliding().next() {
            return refused(b, Obstacle::Body(a), pairs.len(), "pairs of triangles");
        }
        if let Some(ground) = self.options.ground {
            for (n, body) in self.bodies.iter_mut().enumerate() {
                let mut below = Vec::new();
                body.place()?;
                body.posed.vertices_below(ground.normal, ground.height, &mut below);
                if !below.is_empty() {
                    return refused(n, Obstacle::Ground, below.len(), "vertices");
                }
            }
        }
        Ok(())
    }

    /// Advances the world by one step: detection, contacts, integration. `observer` receives the start of each phase.
    /// Returns counts of collisions and contacts at the start of the step.
    ///
    /// # Errors
    /// When the motion diverges, a number is not finite, or a position is beyond the range of numbers. After an error the world can be read, but not advanced.
    pub fn advance(&mut self, observer: &mut impl Observer) -> Result<Counts, DynamicsError> {
        let mut counts = Counts::default();
        self.bodies.iter_mut().filter(|body| !body.is_asleep()).for_each(Body::save_start);
        observer.enter(Phase::SelfCollision);
        self.detect_self_collisions()?;
        for body in &self.bodies {
            counts.self_colliding += usize::from(!body.pairs.is_empty());
            counts.self_pairs += body.pairs.len();
            counts.root_failed += usize::from(body.root_failed);
        }
        observer.enter(Phase::InterObject);
        self.body_collisions.update(&mut self.bodies)?;
        for found in self.body_collisions.colliding() {
            counts.colliding_bodies += 1;
            counts.inter_pairs += found.pairs.len();
        }
        observer.enter(Phase::Ground);
        self.find_ground_contacts()?;
        counts.ground = self.ground_contacts.iter().map(|contacts| contacts.count).sum();
        observer.enter(Phase::Contacts);
        let within = matches!(self.options.response, Response::Contact | Response::Penalty);
        let max_age = 1.0 / (self.options.contact.frequency * self.options.step);
        let (skin, max_age) = (self.skin(), f64::max(max_age, 2.0) as u32);
        self.contacts.update(&self.bodies, within, &self.body_collisions, skin, max_age);
        counts.contacts = self.contacts.list.iter().filter(|contact| !contact.is_duplicate).count();
        self.sorted_contacts = self.contacts.list.len();
        self.join_islands();
        self.solver.constraints.clear();
        let (preload_rate, friction) = (self.preload_rate(), self.options.contact.friction);
        let constraints = &mut self.solver.constraints;
        self.contacts.add_constraints(&self.bodies, skin, preload_rate, friction, constraints);
        let mut buffers = std::mem::take(&mut self.buffers);
        buffers.begin(&self.bodies);
        self.solve_contacts();
        observer.enter(Phase::Dynamics);
        self.advance_bodies()?;
        self.shortened_bodies = 0;
        self.corrections.list.clear();
        if self.bodies.len() > 1 {
            observer.enter(Phase::InterObject);
        }
        self.limit_step(&mut buffers, observer)?;
        self.resist_rolling();
        self.buffers = buffers;
        self.record_impulses();
        self.contacts.end_step(self.sorted_contacts);
        self.check_energy()?;
        self.bodies.iter().filter(|body| !body.is_asleep()).try_for_each(Body::check_range)?;
        self.settle();
        observer.enter(Phase::Done);
        self.step += 1;
        Ok(counts)
    }

    /// Detects self-collisions of all bodies that are awake.
    fn detect_self_collisions(&mut self) -> Result<(), DynamicsError> {
        if self.options.response == Response::Constrain {
            return Ok(());
        }
        let detect = |body: &mut Body| if body.is_asleep() { Ok(()) } else { body.detect() };
        match &mut self.bodies[..] {
            [body] => detect(body),
            bodies => first_error(bodies.par_iter_mut().map(detect).collect()),
        }
    }

    /// Finds the vertices of all bodies that are awake near the ground.
    fn find_ground_contacts(&mut self) -> Result<(), DynamicsError> {
        let Some(options) = self.ground_options() else { return Ok(()) };
        let rigid = self.rigid_contacts;
        let update = |(body, contacts): (&mut Body, &mut GroundContacts)| {
            if !body.is_asleep() {
                contacts.update(body, &options)?;
                contacts.begin(body, &options.ground, &rigid);
            }
            Ok(())
        };
        match (&mut self.bodies[..], &mut self.ground_contacts[..]) {
            ([body], [contacts]) => update((body, contacts)),
            (bodies, contacts) => first_error(bodies.par_iter_mut().zip(contacts).map(update).collect()),
        }
    }

    /// Returns the options of contacts with the ground, if there is a ground.
    pub(crate) fn ground_options(&self) -> Option<GroundOptions> {
        let ground = self.options.ground?;
        Some(GroundOptions { ground, skin: self.skin() })
    }

    /// Share of the difference between half the skin and the gap by which preloads change in a step.
    fn preload_rate(&self) -> f64 {
        (PRELOAD_ADAPTATION * self.options.contact.rate() * self.options.step).min(1.0)
    }

    /// Solves the contact constraints.
    fn solve_contacts(&mut self) {
        let contact = &self.options.contact;
        let (rate, damping, max_iterations) = (contact.rate(), contact.damping, contact.iterations);
        let spring = Spring { rate, damping, step: self.options.step, max_iterations };
        self.solver.solve(&mut self.bodies, &self.contacts.list, &spring);
    }

    /// Stores the impulses of the step.
    fn record_impulses(&mut self) {
        self.impulses.clear();
        let soft = self.solver.constraints.iter().map(|one| (one.bodies, one.source, one.impulse()));
        let rigid = self.corrections.list.iter().map(|one| (one.bodies, one.source, one.total_impulse()));
        for (bodies, source, impulse) in soft.chain(rigid) {
            for (n, sign) in [(0, 1.0), (1, -1.0)] {
                if bodies[n] == GROUND || impulse == DVec3::ZERO {
                    continue;
                }
                // A contact within one body gives an impulse at each of its two points.
                let number = bodies[n] as usize;
                let body = &self.bodies[number];
                let is_within = bodies[0] == bodies[1];
                let to_rest =
                    if is_within { glam::DQuat::IDENTITY } else { body.rigid.orientation.inverse() };
                let (vertices, weights) = match source {
                    Source::Vertex(v) => ([v; 3], [1.0, 0.0, 0.0]),
                    Source::Contact(contact) => {
                        let anchor = &self.contacts.list[contact as usize].anchors[n];
                        (body.shape().model().mesh().faces()[anchor.triangle as usize], anchor.weights)
                    }
                };
                let impulse = to_rest * impulse * sign;
                self.impulses.push(Impulse { body: number, vertices, weights, impulse });
            }
        }
    }

    /// Advances all bodies that are awake by one step, after their contacts are solved.
    fn advance_bodies(&mut self) -> Result<(), DynamicsError> {
        let WorldOptions { gravity, step, response, .. } = self.options;
        let advance = |buffers: &mut NewmarkBuffers, body: &mut Body| {
            if body.is_asleep() {
                return Ok(());
            }
            body.save_start();
            body.advance(gravity, step, buffers)?;
            if response == Response::Constrain {
                constrain_to_root(body)?;
            }
            body.save_trial();
            Ok(())
        };
        let number = self.step;
        let named = |(body, result): (usize, Result<(), DynamicsError>)| {
            result.map_err(|error| match error {
                DynamicsError::Unsolved { energy } => DynamicsError::Diverged { step: number, body, energy },
                other => other,
            })
        };
        match &mut self.bodies[..] {
            [body] => named((0, advance(&mut self.newmark, body))),
            bodies => {
                let all = bodies.par_iter_mut().map_init(NewmarkBuffers::default, advance);
                let results: Vec<_> = all.collect();
                results.into_iter().enumerate().try_for_each(named)
            }
        }
    }

    /// Checks that the motion does not diverge.
    fn check_energy(&self) -> Result<(), DynamicsError> {
        let gravity = self.options.gravity;
        let (mut kinetic, mut potential, mut fastest) = (0.0, 0.0, (0, 0.0));
        for (n, body) in self.bodies.iter().enumerate() {
            let own = body.kinetic_energy();
            if own >= fastest.1 || !own.is_finite() {
                fastest = (n, own);
            }
            kinetic += own;
            potential += body.potential(gravity);
        }
        let available = self.start.energy + (self.start.potential - potential).max(0.0);
        let rounding = ENERGY_ROUNDING * (self.start.potential.abs() + potential.abs());
        if kinetic.is_finite() && kinetic <= MAX_ENERGY_RATIO * available + rounding {
            Ok(())
        } else {
            Err(DynamicsError::Diverged { step: self.step, body: fastest.0, energy: fastest.1 })
        }
    }
}
