//! Limits a step to motions in which no body intersects itself or another one, and none sinks into the ground.
//!
//! Contacts act at the end of the step: a correction displaces it as little as they need, and changes the velocities
//! accordingly. Swept queries then find the pairs of triangles, of different bodies and of the same one, that have a point in
//! common on the way to the corrected end, and a search finds the vertices that sink there. They become contacts, and the
//! correction is computed again. Bodies that still meet themselves, each other or the ground after a few corrections move
//! only a share of their way. So a state with intersections is never reached from one without (Harmon et al. 2009 and Li et
//! al. 2020 argue for the same invariant).

use glam::DVec3;
use rayon::prelude::*;

use crate::body::Body;
use crate::contact_constraint::Source;
use crate::error::first_error;
use crate::ground_contacts::GroundContacts;
use crate::step_buffers::StepBuffers;
use crate::{DynamicsError, Observer, Phase, Response, World};

/// Maximum number of corrections of a step.
const MAX_CORRECTIONS: usize = 8;

/// Share of the time of impact at which the geometry of a contact is computed, and to which bodies move that no correction
/// keeps apart: the triangles are still apart.
const CONTACT_TIME: f64 = 0.9;

/// Distance, in skins, within which triangles near an impact make contacts.
const NEAR_MARGIN: f64 = 2.0;

/// Where a body could move only a smaller share of its way, it keeps its place.
const MIN_SHARE: f64 = 1e-3;

/// Maximum number of times for which bodies are moved a share of their way; then they keep their place.
const MAX_SHORTENINGS: usize = 4;

impl World {
    /// Corrects the end of this step until no two bodies intersect on the way to it, and none sinks into the ground.
    pub(crate) fn limit_step(
        &mut self,
        buffers: &mut StepBuffers,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        self.corrections.begin(&self.bodies);
        buffers.energies.clear();
        buffers.energies.resize(self.bodies.len(), None);
        self.recover_gaps(buffers);
        self.mark_islands(buffers);
        self.correct(buffers);
        for (moves, body) in buffers.moves.iter_mut().zip(&self.bodies) {
            *moves = !body.is_asleep();
        }
        for round in 0.. {
            self.find_impacts(buffers, observer)?;
            self.find_sinking(buffers, round < MAX_CORRECTIONS)?;
            if buffers.impacts.is_empty() && !buffers.sinks.contains(&true) {
                break;
            }
            if round == MAX_CORRECTIONS {
                self.shorten(buffers, observer)?;
                break;
            }
            self.begin_contacts(buffers)?;
            self.correct(buffers);
        }
        self.limit_potential(buffers, observer)?;
        self.stop_contacts();
        self.limit_energy(&buffers.energies);
        self.keep_impulses();
        Ok(())
    }

    /// Stores the impulses of corrections in their contacts.
    fn keep_impulses(&mut self) {
        for one in &self.corrections.list {
            let (normal_impulse, friction_impulse) = (one.normal_impulse, one.friction_impulse);
            match one.source {
                Source::Contact(contact) => {
                    let contact = &mut self.contacts.list[contact as usize];
                    (contact.normal_impulse, contact.friction_impulse) = (normal_impulse, friction_impulse);
                }
                Source::Vertex(vertex) => {
                    let contacts = &mut self.ground_contacts[one.bodies[0] as usize];
                    if let Ok(n) = contacts.find(vertex) {
                        let point = &mut contacts.points[n];
                        (point.normal_impulse, point.friction_impulse) = (normal_impulse, friction_impulse);
                    }
                }
            }
        }
    }

    /// Selects the bodies that are awake in islands with rigid contacts or points on the ground.
    fn mark_islands(&mut self, buffers: &mut StepBuffers) {
        let moves = &mut buffers.moves;
        moves.fill(false);
        for contact in self.contacts.list.iter().filter(|contact| contact.is_rigid) {
            moves[self.islands.of(contact.bodies[0] as usize)] = true;
        }
        for (n, ground) in self.ground_contacts.iter().enumerate() {
            if !ground.points.is_empty() {
                moves[self.islands.of(n)] = true;
            }
        }
        for n in (0..moves.len()).rev() {
            // The first body of an island decides, and is visited last.
            moves[n] = moves[self.islands.of(n)] && !self.bodies[n].is_asleep();
        }
    }

    /// Finds the impacts of the selected bodies with others and with themselves.
    pub(crate) fn find_impacts(
        &mut self,
        buffers: &mut StepBuffers,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        buffers.impacts.clear();
        if self.bodies.len() > 1 {
            self.body_collisions.find_impacts(&mut self.bodies, &buffers.moves)?;
            let found = self.body_collisions.impacts();
            buffers.impacts.extend(found.flat_map(|(bodies, all)| all.iter().map(move |one| (bodies, *one))));
        }
        if self.options.response != Response::Contact {
            return Ok(());
        }
        // A comparison answers all others.
        let is_uncertain =
            self.bodies.iter().zip(&buffers.moves).any(|(body, moves)| *moves && !body.is_root_certified());
        if is_uncertain {
            observer.enter(Phase::SelfCollision);
        }
        let find = |(body, moves): (&mut Body, &bool)| {
            if *moves { body.find_own_impacts() } else { Ok(()) }
        };
        match &mut self.bodies[..] {
            [body] => find((body, &buffers.moves[0]))?,
            bodies => first_error(bodies.par_iter_mut().zip(&buffers.moves).map(find).collect())?,
        }
        for (n, body) in self.bodies.iter().enumerate().filter(|(n, _)| buffers.moves[*n]) {
            buffers.impacts.extend(body.impacts.iter().map(|one| ([n, n], *one)));
        }
        if is_uncertain {
            observer.enter(if self.bodies.len() > 1 { Phase::InterObject } else { Phase::Dynamics });
        }
        Ok(())
    }

    /// Finds the selected bodies that sink into the ground. `makes_points` makes points of their lowest vertices, and also
    /// selects bodies that come too near.
    pub(crate) fn find_sinking(
        &mut self,
        buffers: &mut StepBuffers,
        makes_points: bool,
    ) -> Result<(), DynamicsError> {
        let StepBuffers { moves, sinks, .. } = buffers;
        sinks.fill(false);
        let Some(options) = self.ground_options() else { return Ok(()) };
        let rigid = self.rigid_contacts;
        let find =
            |((moves, sinks), (body, contacts)): ((&bool, &mut bool), (&mut Body, &mut GroundContacts))| {
                if *moves {
                    contacts.update(body, &options)?;
                    let is_near = makes_points && contacts.add_sinking(body, &options.ground, &rigid);
                    *sinks = is_near || contacts.sinks_after().is_some();
                }
                Ok(())
            };
        match (&mut self.bodies[..], &mut self.ground_contacts[..]) {
            ([body], [contacts]) => find(((&moves[0], &mut sinks[0]), (body, contacts))),
            (bodies, contacts) => {
                let all = bodies.par_iter_mut().zip(contacts);
                first_error(moves.par_iter().zip(sinks).zip(all).map(find).collect())
            }
        }
    }

    /// Solves the contacts of the selected bodies, and moves these to the corrected end of their step.
    fn correct(&mut self, buffers: &mut StepBuffers) {
        let StepBuffers { moves, energies, .. } = buffers;
        if !moves.contains(&true) {
            return;
        }
        let gravity = self.options.gravity;
        let bodies = self.bodies.par_iter().zip(&*moves).zip(energies);
        bodies.filter(|((_, moves), energies)| **moves && energies.is_none()).for_each(
            |((body, _), energies)| {
                *energies = Some(body.energies(gravity));
            },
        );
        self.keep_impulses();
        let friction = self.options.contact.friction;
        let (contacts, rigid) = (&self.contacts.list, &self.rigid_contacts);
        let ground = (&self.ground_contacts[..], self.options.ground);
        self.corrections.gather(&self.bodies, ground, contacts, rigid, friction);
        self.corrections.solve(&mut self.bodies, contacts, rigid, moves);
        if self.options.response == Response::Constrain {
            for (body, _) in self.bodies.iter_mut().zip(&*moves).filter(|(_, moves)| **moves) {
                // A q that is not finite fails the next swept query.
                let _ = crate::root_constraint::constrain_to_root(body);
            }
        }
    }

    /// Makes contacts of impacts and of triangles near them, and selects the islands of their bodies.
    fn begin_contacts(&mut self, buffers: &mut StepBuffers) -> Result<(), DynamicsError> {
        let StepBuffers { moves, sinks, impacts, near, gathered, .. } = buffers;
        for ([a, b], _) in &*impacts {
            self.islands.join(*a, *b);
        }
        moves.fill(false);
        for ([a, _], _) in &*impacts {
            moves[self.islands.of(*a)] = true;
        }
        for n in (0..moves.len()).filter(|n| sinks[*n]) {
            moves[self.islands.of(n)] = true;
        }
        for n in 0..moves.len() {
            moves[n] = moves[self.islands.of(n)];
        }
        let corners: Vec<[[[DVec3; 3]; 2]; 2]> = impacts
            .iter()
            .map(|([a, b], impact)| {
                if a == b {
                    let body = &self.bodies[*a];
                    let of = |triangle| [body.start_corners(triangle, true), body.corners(triangle)];
                    return [of(impact.pair.0), of(impact.pair.1)];
                }
                let of = |body: usize, triangle: u32| {
                    let body = &self.bodies[body];
                    body.swept
                        .as_ref()
                        .map_or_else(|| [body.world_corners(triangle); 2], |swept| swept.corners(triangle))
                };
                [of(*a, impact.pair.0), of(*b, impact.pair.1)]
            })
            .collect();
        // Other triangles near those that meet would be found in the next rounds.
        near.clear();
        let skin = self.skin();
        for (bodies, _) in &*impacts {
            if bodies[0] != bodies[1] && !gathered.contains(bodies) {
                gathered.push(*bodies);
                self.body_collisions.find_near(&mut self.bodies, *bodies, NEAR_MARGIN * skin, near);
            }
        }
        near.extend(
            impacts.iter().filter(|(bodies, _)| bodies[0] == bodies[1]).map(|(n, one)| (*n, one.pair)),
        );
        near.retain(|(bodies, pair)| {
            let (indices, sorted) = (bodies.map(|n| n as u32), self.sorted_contacts);
            // A pair of one body may meet again after a correction, those of two bodies are gathered once.
            let has_begun = bodies[0] == bodies[1] && self.contacts.has_begun(indices, *pair, sorted);
            !has_begun && !self.contacts.has_rigid(indices, *pair, sorted)
        });
        self.wake(moves)?;
        let first = self.contacts.list.len();
        for (numbers, pair) in &*near {
            let bodies = numbers.map(|n| &self.bodies[n]);
            self.contacts.begin_near(numbers.map(|n| n as u32), *pair, bodies, skin);
        }
        for contact in &mut self.contacts.list[first..] {
            contact.min_gap = self.rigid_contacts.kept_gap(contact.gap);
        }
        for ((numbers, impact), corners) in impacts.iter().zip(&corners) {
            let bodies = numbers.map(|n| &self.bodies[n]);
            let time = impact.time * CONTACT_TIME;
            let at = corners.map(|[t0, t1]| std::array::from_fn(|n| t0[n].lerp(t1[n], time)));
            let (indices, sorted) = (numbers.map(|n| n as u32), self.sorted_contacts);
            let begun = self.contacts.begin_impact(indices, impact.pair, bodies, &at, sorted);
            if let Some((contact, distance)) = begun {
                contact.min_gap = self.rigid_contacts.kept_gap(distance);
            }
        }
        Ok(())
    }

    /// Moves bodies with impacts or vertices below the ground a share of their way, until none are left.
    pub(crate) fn shorten(
        &mut self,
        buffers: &mut StepBuffers,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        let mut shares = vec![1.0_f64; self.bodies.len()];
        let mut is_shortened = vec![false; self.bodies.len()];
        for round in 0.. {
            let mut times = vec![f64::INFINITY; self.bodies.len()];
            for (bodies, impact) in &buffers.impacts {
                bodies.iter().for_each(|n| times[*n] = times[*n].min(impact.time));
            }
            for (n, time) in times.iter_mut().enumerate().filter(|(n, _)| buffers.sinks[*n]) {
                *time = time.min(self.ground_contacts[n].sinks_after().unwrap_or(f64::INFINITY));
            }
            buffers.moves.fill(false);
            for (n, time) in times.into_iter().enumerate() {
                if time.is_finite() && shares[n] > 0.0 && !self.bodies[n].is_asleep() {
                    let mut share = CONTACT_TIME * time;
                    if shares[n] * share < MIN_SHARE || round >= MAX_SHORTENINGS {
                        share = 0.0;
                    }
                    shares[n] *= share;
                    // A body that no correction has moved pays for its energy, too.
                    let body = &mut self.bodies[n];
                    buffers.energies[n].get_or_insert_with(|| body.energies(self.options.gravity));
                    body.shorten(share);
                    (buffers.moves[n], is_shortened[n]) = (true, true);
                }
            }
            if !buffers.moves.contains(&true) {
                break;
            }
            self.find_impacts(buffers, observer)?;
            self.find_sinking(buffers, false)?;
            if buffers.impacts.is_empty() && !buffers.sinks.contains(&true) {
                break;
            }
        }
        self.shortened_bodies += is_shortened.iter().filter(|is_shortened| **is_shortened).count();
        Ok(())
    }
}
