//! World of bodies, and its time step: detection, contacts, integration.

use rayon::prelude::*;

use crate::body::{Body, Start};
use crate::constrain::constrain;
use crate::contacts::Contacts;
use crate::detect::Neighbours;
use crate::near_ground::NearGround;
use crate::solve::{GROUND, Solver, Source, Spring};
use crate::{
    BodyPairs, Counts, DynamicsError, Impulse, Observer, Obstacle, Phase, Response, Shape, WorldOptions,
};

/// Bodies with their ground, contacts and options. The same steps give the same bits in every run and for any number of
/// threads.
pub struct World<'a> {
    options: WorldOptions,
    pub(crate) bodies: Vec<Body<'a>>,
    pub(crate) near: Vec<NearGround>,
    neighbours: Neighbours,
    pub(crate) contacts: Contacts,
    solver: Solver,
    start: Reference,
    pub(crate) step: u64,
    pub(crate) impulses: Vec<Impulse>,
}

/// Total energies of all bodies at the start. They bound the kinetic energy of later steps.
#[derive(Clone, Copy, Debug, Default)]
struct Reference {
    energy: f64,
    potential: f64,
}

/// So many times the kinetic energy that can be is a divergence.
const BLOW_UP: f64 = 4.0;

/// How fast springs adapt to a load that lasts, beside their own rate. Fast enough to hold in a few seconds what
/// rests, so slow that an impact hardly notices.
const CREEP: f64 = 1.0 / 300.0;

impl<'a> World<'a> {
    /// Creates a world without bodies.
    ///
    /// # Errors
    /// When an option is outside its range.
    pub fn new(options: WorldOptions) -> Result<Self, DynamicsError> {
        options.check()?;
        Ok(Self {
            options,
            bodies: Vec::new(),
            near: Vec::new(),
            neighbours: Neighbours::default(),
            contacts: Contacts::default(),
            solver: Solver::default(),
            start: Reference::default(),
            step: 0,
            impulses: Vec::new(),
        })
    }

    /// Adds a body and returns its number. Bodies of one shape share its certificates.
    ///
    /// # Errors
    /// When the initial state is invalid: see [`Start`].
    pub fn add(&mut self, shape: &'a Shape, start: &Start) -> Result<usize, DynamicsError> {
        let twin = self.bodies.iter().find(|body| std::ptr::eq(body.shape(), shape));
        let body = Body::new(shape, start, &self.options, twin)?;
        self.start.energy += body.energy();
        self.start.potential += body.potential(self.options.gravity);
        self.bodies.push(body);
        self.near.push(NearGround::default());
        Ok(self.bodies.len() - 1)
    }

    /// Returns the options of the world.
    pub fn options(&self) -> &WorldOptions {
        &self.options
    }

    /// Returns all bodies, in the order of their numbers.
    pub fn bodies(&self) -> &[Body<'a>] {
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
        self.bodies.iter().map(|body| body.ledger).sum()
    }

    /// Returns the impulses of the last step, in the order of contacts.
    pub fn impulses(&self) -> &[Impulse] {
        &self.impulses
    }

    /// Returns the colliding bodies and their triangle pairs at the start of the last step.
    pub fn inter_pairs(&self) -> impl Iterator<Item = BodyPairs<'_>> {
        self.neighbours.colliding()
    }

    /// Returns the skin: the distance at which bodies in contact are held apart (model unit).
    pub fn skin(&self) -> f64 {
        let smallest = || self.bodies.iter().map(|body| body.shape().radius()).fold(f64::INFINITY, f64::min);
        self.options.contact.skin.unwrap_or_else(|| 1e-3 * smallest())
    }

    /// Checks that no body penetrates another one, the ground or itself. Self-collisions are rejected only with
    /// [`Response::Contact`], where contacts would push surfaces that constraint at rest apart for ever.
    ///
    /// # Errors
    /// When a body penetrates; the error names the first one.
    pub fn check_start(&mut self) -> Result<(), DynamicsError> {
        let refused =
            |body, what, count, unit| Err(DynamicsError::Interpenetration { body, what, count, unit });
        if self.options.response == Response::Contact {
            self.detect_within()?;
            if let Some(body) = self.bodies.iter().position(|body| !body.pairs.is_empty()) {
                return refused(body, Obstacle::Itself, self.bodies[body].pairs.len(), "pairs of triangles");
            }
        }
        self.neighbours.update(&mut self.bodies)?;
        if let Some(BodyPairs { bodies: [a, b], pairs }) = self.neighbours.colliding().next() {
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
    /// When the motion diverges or a number is not finite. After an error the world can be read, but not advanced.
    pub fn advance(&mut self, observer: &mut impl Observer) -> Result<Counts, DynamicsError> {
        let mut counts = Counts::default();
        observer.enter(Phase::SelfCollision);
        self.detect_within()?;
        for body in &self.bodies {
            counts.self_colliding += usize::from(!body.pairs.is_empty());
            counts.self_pairs += body.pairs.len();
            counts.root_failed += usize::from(body.root_failed);
        }
        observer.enter(Phase::InterObject);
        self.neighbours.update(&mut self.bodies)?;
        for met in self.neighbours.colliding() {
            counts.colliding_bodies += 1;
            counts.inter_pairs += met.pairs.len();
        }
        observer.enter(Phase::Ground);
        self.solver.touches.clear();
        self.touch_ground()?;
        counts.ground = self.solver.touches.len();
        observer.enter(Phase::Penalty);
        let (skin, creep, friction) = (self.skin(), self.creep(), self.options.contact.friction);
        let within = self.options.response == Response::Contact;
        let patience = 1.0 / (self.options.contact.frequency * self.options.step);
        self.contacts.update(&self.bodies, within, &self.neighbours, skin, patience.max(2.0) as u32);
        counts.contacts = self.contacts.list.len();
        self.contacts.touch(&self.bodies, skin, creep, friction, &mut self.solver.touches);
        self.push();
        observer.enter(Phase::Dynamics);
        self.move_on()?;
        observer.enter(Phase::Done);
        self.step += 1;
        Ok(counts)
    }

    fn detect_within(&mut self) -> Result<(), DynamicsError> {
        if self.options.response == Response::Constrain {
            return Ok(());
        }
        match &mut self.bodies[..] {
            [body] => body.detect(),
            bodies => first_error(bodies.par_iter_mut().map(Body::detect).collect()),
        }
    }

    fn touch_ground(&mut self) -> Result<(), DynamicsError> {
        let Some(ground) = self.options.ground else { return Ok(()) };
        let (skin, creep) = (self.skin(), self.creep());
        for (n, (body, near)) in self.bodies.iter_mut().zip(&mut self.near).enumerate() {
            near.update(body, &ground, skin)?;
            near.touch(n as u32, body, &ground, skin, creep, &mut self.solver.touches);
        }
        Ok(())
    }

    /// Share of the difference between half the skin and the gap by which preloads change in a step.
    fn creep(&self) -> f64 {
        (CREEP * self.options.contact.rate() * self.options.step).min(1.0)
    }

    fn push(&mut self) {
        self.impulses.clear();
        if self.solver.touches.is_empty() {
            return;
        }
        let contact = &self.options.contact;
        let (rate, damping, rounds) = (contact.rate(), contact.damping, contact.rounds);
        let spring = Spring { rate, damping, step: self.options.step, rounds };
        self.solver.solve(&mut self.bodies, &self.contacts.list, &spring);
        for touch in &self.solver.touches {
            let impulse = touch.normal * touch.pressure + touch.drag;
            for (n, sign) in [(0, 1.0), (1, -1.0)] {
                if touch.bodies[n] == GROUND {
                    continue;
                }
                // Within one body both points are told.
                let body = &self.bodies[touch.bodies[n] as usize];
                let turn =
                    if touch.is_within() { glam::DQuat::IDENTITY } else { body.rigid.orientation.inverse() };
                let (vertices, weights) = match touch.source {
                    Source::Vertex(v) => ([v; 3], [1.0, 0.0, 0.0]),
                    Source::Contact(contact) => {
                        let anchor = &self.contacts.list[contact as usize].anchors[n];
                        (body.shape().model().mesh().faces()[anchor.triangle as usize], anchor.weights)
                    }
                };
                let impulse = turn * impulse * sign;
                self.impulses.push(Impulse { body: touch.bodies[n] as usize, vertices, weights, impulse });
            }
        }
    }

    fn move_on(&mut self) -> Result<(), DynamicsError> {
        let WorldOptions { gravity, step, response, .. } = self.options;
        let advance = |body: &mut Body<'a>| {
            body.advance(gravity, step)?;
            if response == Response::Constrain { constrain(body) } else { Ok(()) }
        };
        let number = self.step;
        let diverged = |body, energy| DynamicsError::Diverged { step: number, body, energy };
        let named = |(body, result): (usize, Result<(), DynamicsError>)| {
            result.map_err(|error| match error {
                DynamicsError::Unsolved { energy } => diverged(body, energy),
                other => other,
            })
        };
        match &mut self.bodies[..] {
            [body] => named((0, advance(body)))?,
            bodies => {
                let results: Vec<_> = bodies.par_iter_mut().map(advance).collect();
                results.into_iter().enumerate().try_for_each(named)?;
            }
        }
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
        if kinetic.is_finite() && kinetic <= BLOW_UP * available {
            Ok(())
        } else {
            Err(diverged(fastest.0, fastest.1))
        }
    }
}

fn first_error(results: Vec<Result<(), DynamicsError>>) -> Result<(), DynamicsError> {
    results.into_iter().collect()
}
