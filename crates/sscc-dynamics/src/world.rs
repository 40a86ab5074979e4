//! World of bodies, and its time step: detection, contacts, integration.

use rayon::prelude::*;

use crate::bodies::root_constraint::constrain_to_root;
use crate::contacts::contact_laws::ContactLaws;
use crate::contacts::ground_contacts::GroundContacts;
use crate::contacts::solver::contact_solver::{ContactSolver, Spring};
use crate::contacts::world_contacts::WorldContacts;
use crate::error::first_error;
use crate::step::divergence::StartEnergy;
use crate::step::impulses;
use crate::step::rolling::resist_rolling;
use crate::step::sleep::Sleep;
use crate::step::step_limiter::StepLimiter;
use crate::{
    Body, BodyPairs, Counts, DynamicsError, Impulse, NewmarkBuffers, Observer, Obstacle, Phase, Response,
    Shape, Start, State, WorldOptions,
};

/// Bodies with their ground, contacts and options. The same steps give the same bits in every run and for any number of
/// threads.
pub struct World {
    options: WorldOptions,
    bodies: Vec<Body>,
    contacts: WorldContacts,
    /// Solver of soft contacts.
    solver: ContactSolver,
    limiter: StepLimiter,
    sleep: Sleep,
    /// Buffers of the integration of a single body.
    newmark: NewmarkBuffers,
    start: StartEnergy,
    step: u64,
    impulses: Vec<Impulse>,
}

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
            contacts: WorldContacts::new(ContactLaws::new(&options, 0.0)),
            solver: ContactSolver::default(),
            limiter: StepLimiter::new(options.gravity),
            sleep: Sleep::default(),
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
        self.start.add(&body, self.options.gravity);
        self.bodies.push(body);
        self.contacts.ground.push(GroundContacts::default());
        self.contacts.laws = ContactLaws::new(&self.options, self.skin());
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

    /// Returns the impulses of the last step, in the order of contacts; none if the step failed before they were computed.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// Returns the colliding bodies and their triangle pairs at the start of the last step.
    pub fn inter_pairs(&self) -> impl Iterator<Item = BodyPairs<'_>> {
        self.contacts.collisions.colliding()
    }

    /// Returns the number of bodies that moved only a part of their motion in the last step, because no correction kept them
    /// apart, or because the corrected end had too much elastic energy.
    pub fn shortened_bodies(&self) -> usize {
        self.limiter.shortened_bodies
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
        if self.contacts.laws.act_within_bodies() {
            self.detect_self_collisions()?;
            if let Some(body) = self.bodies.iter().position(|body| !body.pairs.is_empty()) {
                return refused(body, Obstacle::Itself, self.bodies[body].pairs.len(), "pairs of triangles");
            }
        }
        self.contacts.collisions.update(&mut self.bodies)?;
        if let Some(BodyPairs { bodies: [a, b], pairs }) = self.contacts.collisions.colliding().next() {
            return refused(b, Obstacle::Body(a), pairs.len(), "pairs of triangles");
        }
        if let Some(ground) = self.options.ground {
            for (n, body) in self.bodies.iter_mut().enumerate() {
                let mut below = Vec::new();
                body.place()?;
                body.posed.vertices_below(ground.normal, ground.height, &mut below)?;
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
        self.impulses.clear();
        self.bodies.iter_mut().filter(|body| !body.is_asleep()).for_each(Body::save_start);
        observer.enter(Phase::SelfCollision);
        self.detect_self_collisions()?;
        observer.enter(Phase::InterObject);
        self.contacts.collisions.update(&mut self.bodies)?;
        observer.enter(Phase::Ground);
        self.contacts.begin_ground(&mut self.bodies)?;
        observer.enter(Phase::Contacts);
        self.contacts.begin_triangles(&self.bodies);
        let counts = self.counts();
        self.solve_soft_contacts();
        observer.enter(Phase::Dynamics);
        self.advance_bodies()?;
        if self.bodies.len() > 1 {
            observer.enter(Phase::InterObject);
        }
        self.limiter.limit(&mut self.bodies, &mut self.contacts, observer)?;
        resist_rolling(&mut self.bodies, &self.limiter.corrections.list);
        self.record_impulses();
        self.contacts.triangles.end_step();
        self.start.check(&self.bodies, self.options.gravity, self.step)?;
        self.bodies.iter().filter(|body| !body.is_asleep()).try_for_each(Body::check_range)?;
        self.sleep.settle(&mut self.bodies, &mut self.contacts, &self.options);
        observer.enter(Phase::Done);
        self.step += 1;
        Ok(counts)
    }

    /// Returns the counts of collisions and contacts in the current state.
    fn counts(&self) -> Counts {
        let mut counts = Counts::default();
        for body in &self.bodies {
            counts.self_colliding += usize::from(!body.pairs.is_empty());
            counts.self_pairs += body.pairs.len();
            counts.root_failed += usize::from(body.root_failed);
        }
        for found in self.inter_pairs() {
            counts.colliding_bodies += 1;
            counts.inter_pairs += found.pairs.len();
        }
        counts.ground = self.contacts.ground.iter().map(|contacts| contacts.count).sum();
        counts.contacts = self.contacts.triangles.list.iter().filter(|one| !one.is_duplicate).count();
        counts
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

    /// Solves the soft contacts of this step.
    fn solve_soft_contacts(&mut self) {
        let WorldContacts { laws, triangles, .. } = &mut self.contacts;
        self.solver.constraints.clear();
        triangles.add_constraints(&self.bodies, laws, &mut self.solver.constraints);
        let contact = &self.options.contact;
        let (rate, damping, max_iterations) = (contact.rate(), contact.damping, contact.iterations);
        let spring = Spring { rate, damping, step: self.options.step, max_iterations };
        self.solver.solve(&mut self.bodies, &triangles.list, &spring);
    }

    /// Stores the impulses of the step.
    fn record_impulses(&mut self) {
        let soft = self.solver.constraints.iter().map(|one| (&one.points, one.impulse()));
        let rigid = self.limiter.corrections.list.iter().map(|one| (&one.points, one.total_impulse()));
        let contacts = &self.contacts.triangles.list;
        impulses::record(soft.chain(rigid), &self.bodies, contacts, &mut self.impulses);
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

    /// Returns the current state.
    pub fn state(&self) -> State {
        State::of(self.step, &self.bodies, &self.contacts)
    }

    /// Restores a state of a world with the same options and bodies.
    ///
    /// # Errors
    /// When the state does not fit the bodies or holds an invalid number; then the world is unchanged.
    pub fn restore(&mut self, state: &State) -> Result<(), DynamicsError> {
        state.restore(&mut self.bodies, &mut self.contacts)?;
        self.step = state.step;
        self.impulses.clear();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::test_shapes::tetrahedron;

    #[test]
    fn a_step_that_fails_does_not_repeat_the_last_impulses() {
        let mut world = World::new(WorldOptions::default()).unwrap();
        // The lowest vertices are 0.1 mm above the ground.
        let start = Start { position: Some(DVec3::Y * 0.2501), ..Start::default() };
        world.add(&tetrahedron(vec![DVec3::ZERO; 4], &[1.0]), &start).unwrap();
        let is_pushed = (0..100).any(|_| {
            world.advance(&mut ()).unwrap();
            !world.impulses().is_empty()
        });
        assert!(is_pushed);
        world.bodies[0].rigid.position = DVec3::NAN;
        assert!(world.advance(&mut ()).is_err());
        assert!(world.impulses().is_empty());
    }
}
