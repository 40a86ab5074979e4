//! Limits a step to motions in which no two bodies intersect.
//!
//! Contacts between bodies act at the end of the step: a correction displaces it as little as they need, and changes the
//! velocities accordingly. A swept query then finds the pairs of triangles that have a point in common on the way to the
//! corrected end. They become contacts, and the correction is computed again. Bodies that still meet after a few
//! corrections move only a share of their way. So a state with intersections between bodies is never reached from one
//! without (Harmon et al. 2009 and Li et al. 2020 argue for the same invariant).

use glam::DVec3;

use crate::contact_constraint::Source;
use crate::step_buffers::StepBuffers;
use crate::{DynamicsError, World};

/// Maximum number of corrections of a step.
const MAX_CORRECTIONS: usize = 8;

/// Share of the time of impact at which the geometry of a contact is computed, and to which bodies move that no correction
/// keeps apart: the triangles are still apart.
const CONTACT_TIME: f64 = 0.9;

/// Distance, in skins, within which triangles near an impact make contacts.
const NEAR_MARGIN: f64 = 2.0;

/// Bodies move less than this share of their way not at all.
const MIN_SHARE: f64 = 1e-3;

/// Maximum number of times for which bodies are moved a share of their way; then they keep their place.
const MAX_SHORTENINGS: usize = 4;

impl World<'_> {
    /// Corrects the end of this step until no two bodies intersect on the way to it.
    pub(crate) fn limit_step(&mut self, buffers: &mut StepBuffers) -> Result<(), DynamicsError> {
        self.corrections.begin(&self.bodies);
        buffers.energies.clear();
        buffers.energies.resize(self.bodies.len(), None);
        let rigid = self.rigid_contacts;
        for contact in self.contacts.list.iter_mut().filter(|contact| contact.is_rigid) {
            contact.min_gap = rigid.kept_gap(contact.gap);
        }
        self.mark_islands(buffers, |contact| contact.is_rigid);
        self.correct(buffers);
        for (moves, body) in buffers.moves.iter_mut().zip(&self.bodies) {
            *moves = !body.is_asleep();
        }
        for round in 0.. {
            self.find_impacts(buffers)?;
            if buffers.impacts.is_empty() {
                break;
            }
            if round == MAX_CORRECTIONS {
                self.shorten(buffers)?;
                break;
            }
            self.begin_contacts(buffers)?;
            self.correct(buffers);
        }
        self.limit_energy(&buffers.energies);
        for one in &self.corrections.list {
            if let Source::Contact(contact) = one.source {
                let contact = &mut self.contacts.list[contact as usize];
                contact.normal_impulse = one.normal_impulse;
                contact.friction_impulse = one.friction_impulse;
            }
        }
        Ok(())
    }

    /// Selects the bodies that are awake in islands with such contacts.
    fn mark_islands(
        &mut self,
        buffers: &mut StepBuffers,
        selects: impl Fn(&crate::contact::Contact) -> bool,
    ) {
        let moves = &mut buffers.moves;
        moves.fill(false);
        for contact in self.contacts.list.iter().filter(|contact| selects(contact)) {
            moves[self.islands.of(contact.bodies[0] as usize)] = true;
        }
        for n in 0..moves.len() {
            moves[n] = moves[self.islands.of(n)] && !self.bodies[n].is_asleep();
        }
    }

    fn find_impacts(&mut self, buffers: &mut StepBuffers) -> Result<(), DynamicsError> {
        self.body_collisions.find_impacts(&mut self.bodies, &buffers.moves)?;
        let found = self.body_collisions.impacts();
        buffers.impacts.clear();
        buffers.impacts.extend(found.flat_map(|(bodies, all)| all.iter().map(move |one| (bodies, *one))));
        Ok(())
    }

    /// Solves the contacts of the selected bodies, and moves these to the corrected end of their step.
    fn correct(&mut self, buffers: &mut StepBuffers) {
        let StepBuffers { moves, energies, .. } = buffers;
        if !moves.contains(&true) {
            return;
        }
        for (n, body) in self.bodies.iter().enumerate() {
            if moves[n] && energies[n].is_none() {
                energies[n] = Some(body.energy() + body.potential(self.options.gravity));
            }
        }
        let friction = self.options.contact.friction;
        let (contacts, rigid) = (&mut self.contacts.list, &self.rigid_contacts);
        for one in &self.corrections.list {
            if let Source::Contact(contact) = one.source {
                let contact = &mut contacts[contact as usize];
                contact.normal_impulse = one.normal_impulse;
                contact.friction_impulse = one.friction_impulse;
            }
        }
        self.corrections.gather(&self.bodies, contacts, &self.solver, rigid, friction);
        self.corrections.solve(&mut self.bodies, contacts, rigid, moves);
        if self.options.response == crate::Response::Constrain {
            for (body, _) in self.bodies.iter_mut().zip(&*moves).filter(|(_, moves)| **moves) {
                // A q that is not finite fails the next swept query.
                let _ = crate::root_constraint::constrain_to_root(body);
            }
        }
    }

    /// Makes contacts of impacts and of triangles near them, and selects the islands of their bodies.
    fn begin_contacts(&mut self, buffers: &mut StepBuffers) -> Result<(), DynamicsError> {
        let StepBuffers { moves, impacts, near, gathered, .. } = buffers;
        for ([a, b], _) in &*impacts {
            self.islands.join(*a, *b);
        }
        moves.fill(false);
        for ([a, _], _) in &*impacts {
            moves[self.islands.of(*a)] = true;
        }
        for n in 0..moves.len() {
            moves[n] = moves[self.islands.of(n)];
        }
        let corners: Vec<[[[DVec3; 3]; 2]; 2]> = impacts
            .iter()
            .map(|([a, b], impact)| {
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
            if !gathered.contains(bodies) {
                gathered.push(*bodies);
                self.body_collisions.find_near(&mut self.bodies, *bodies, NEAR_MARGIN * skin, near);
            }
        }
        near.retain(|(bodies, pair)| {
            !self.contacts.has_rigid(bodies.map(|n| n as u32), *pair, self.sorted_contacts)
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

    /// Moves bodies with impacts a share of their way, until none are left.
    fn shorten(&mut self, buffers: &mut StepBuffers) -> Result<(), DynamicsError> {
        let mut shares = vec![1.0_f64; self.bodies.len()];
        let mut is_shortened = vec![false; self.bodies.len()];
        for round in 0.. {
            let mut times = vec![f64::INFINITY; self.bodies.len()];
            for (bodies, impact) in &buffers.impacts {
                bodies.iter().for_each(|n| times[*n] = times[*n].min(impact.time));
            }
            buffers.moves.fill(false);
            for (n, time) in times.into_iter().enumerate() {
                if time.is_finite() && shares[n] > 0.0 && !self.bodies[n].is_asleep() {
                    let mut share = CONTACT_TIME * time;
                    if shares[n] * share < MIN_SHARE || round >= MAX_SHORTENINGS {
                        share = 0.0;
                    }
                    shares[n] *= share;
                    self.bodies[n].shorten(share);
                    (buffers.moves[n], is_shortened[n]) = (true, true);
                }
            }
            if !buffers.moves.contains(&true) {
                break;
            }
            self.find_impacts(buffers)?;
            if buffers.impacts.is_empty() {
                break;
            }
        }
        self.shortened_bodies += is_shortened.iter().filter(|is_shortened| **is_shortened).count();
        Ok(())
    }
}
