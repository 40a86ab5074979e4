//! Limits a step to motions in which no body intersects itself or another one, and none sinks into the ground.
//!
//! Contacts act at the end of the step: a correction displaces it as little as they need, and changes the velocities
//! accordingly. Swept queries then find the pairs of triangles, of different bodies and of the same one, that have a point in
//! common during the motion to the corrected end, and a search finds the vertices that sink there. They become contacts, and
//! the correction is computed again. Bodies that still meet themselves, each other or the ground after a few corrections move
//! only a part of their motion. So a state with intersections is never reached from one without (Harmon et al. 2009 and Li et
//! al. 2020 argue for the same invariant).

use glam::DVec3;
use rayon::prelude::*;

use super::impact_contacts::{CONTACT_TIME, ImpactContacts};
use super::impacts::Impacts;
use super::island_energy::limit_energy;
use super::phases::Observer;
use super::potential_limit::PotentialLimit;
use crate::bodies::body_set::BodySet;
use crate::bodies::root_constraint::constrain_to_root;
use crate::contacts::islands::PerIsland;
use crate::contacts::solver::correction_solver::CorrectionSolver;
use crate::contacts::world_contacts::WorldContacts;
use crate::{Body, DynamicsError, Response};

/// Maximum number of corrections of a step.
const MAX_CORRECTIONS: usize = 8;

/// A body that could move only a smaller fraction of its motion keeps its place.
const MIN_SHARE: f64 = 1e-3;

/// Maximum number of times that bodies with impacts move back to a part of their motion; then they keep their place.
const MAX_SHORTENINGS: usize = 4;

/// Maximum number of times that bodies with too much potential energy move back to half of their motion; then they keep their
/// place.
const MAX_HALVINGS: u32 = 4;

/// Limits steps. All buffers are kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepLimiter {
    pub corrections: CorrectionSolver,
    /// Number of bodies that moved only a part of their motion in this step.
    pub shortened_bodies: usize,
    gravity: DVec3,
    /// Bodies that the current correction moves, or whose motion it tests.
    selected: BodySet,
    selected_islands: PerIsland<bool>,
    impacts: Impacts,
    impact_contacts: ImpactContacts,
    potential_limit: PotentialLimit,
    /// Energies of each corrected body at the beginning of the step and before its correction; None for all other bodies.
    energies: Vec<Option<[f64; 2]>>,
}

impl StepLimiter {
    pub fn new(gravity: DVec3) -> Self {
        Self { gravity, ..Self::default() }
    }

    /// Corrects the end of this step until no two bodies intersect during the motion to it, and none sinks into the ground.
    pub fn limit(
        &mut self,
        bodies: &mut [Body],
        contacts: &mut WorldContacts,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        self.shortened_bodies = 0;
        self.impact_contacts.begin_step();
        self.corrections.begin(bodies);
        self.energies.clear();
        self.energies.resize(bodies.len(), None);
        contacts.recover_gaps(bodies);
        self.select_held(bodies, contacts);
        self.correct(bodies, contacts);
        self.selected.set(bodies.iter().map(|body| !body.is_asleep()));
        for round in 0.. {
            let is_last = round == MAX_CORRECTIONS;
            self.impacts.find(bodies, contacts, &self.selected, !is_last, observer)?;
            if self.impacts.is_empty() {
                break;
            }
            if is_last {
                self.shorten(bodies, contacts, observer)?;
                break;
            }
            self.select_meeting(bodies.len(), contacts);
            self.impact_contacts.begin(bodies, contacts, &self.impacts.pairs, &self.selected)?;
            self.correct(bodies, contacts);
        }
        self.limit_potential(bodies, contacts, observer)?;
        self.corrections.stop_contacts(bodies, &contacts.triangles.list);
        limit_energy(bodies, contacts, self.gravity, &self.energies);
        contacts.keep_impulses(&self.corrections.list);
        Ok(())
    }

    /// Selects the bodies that are awake in islands with rigid contacts or points on the ground.
    fn select_held(&mut self, bodies: &[Body], contacts: &mut WorldContacts) {
        let WorldContacts { ground, triangles, islands, .. } = contacts;
        self.selected_islands.reset(bodies.len(), false);
        for contact in triangles.list.iter().filter(|contact| contact.is_rigid) {
            self.selected_islands[islands.of(contact.bodies[0] as usize)] = true;
        }
        for (n, _) in ground.iter().enumerate().filter(|(_, ground)| !ground.points.is_empty()) {
            self.selected_islands[islands.of(n)] = true;
        }
        islands.select(&self.selected_islands, &mut self.selected);
        let flags = self.selected.flags_mut().iter_mut().zip(bodies);
        flags.for_each(|(is_selected, body)| *is_selected &= !body.is_asleep());
    }

    /// Joins the islands of bodies that meet. Selects the bodies of all islands with impacts.
    fn select_meeting(&mut self, bodies: usize, contacts: &mut WorldContacts) {
        let islands = &mut contacts.islands;
        for ([a, b], _) in &self.impacts.pairs {
            islands.join(*a, *b);
        }
        self.selected_islands.reset(bodies, false);
        let meeting = self.impacts.pairs.iter().map(|([a, _], _)| *a);
        for n in meeting.chain(self.impacts.sinking.members()) {
            self.selected_islands[islands.of(n)] = true;
        }
        islands.select(&self.selected_islands, &mut self.selected);
    }

    /// Solves the contacts of the selected bodies, and moves these to the corrected end of their step.
    fn correct(&mut self, bodies: &mut [Body], contacts: &mut WorldContacts) {
        let Self { selected, energies, corrections, gravity, .. } = self;
        if selected.is_empty() {
            return;
        }
        let all = bodies.par_iter().zip(selected.flags()).zip(energies);
        all.filter(|((_, is_selected), energies)| **is_selected && energies.is_none())
            .for_each(|((body, _), energies)| *energies = Some(body.energies(*gravity)));
        contacts.keep_impulses(&corrections.list);
        let WorldContacts { laws, ground, triangles, .. } = contacts;
        corrections.gather(bodies, ground, &triangles.list, laws);
        corrections.solve(bodies, &triangles.list, laws, selected);
        if laws.response == Response::Constrain {
            for n in selected.members() {
                // A q that is not finite fails the next swept query.
                let _ = constrain_to_root(&mut bodies[n]);
            }
        }
    }

    /// Moves bodies with impacts or vertices below the ground back to a part of their motion, until no impact and no such
    /// vertex remains.
    fn shorten(
        &mut self,
        bodies: &mut [Body],
        contacts: &mut WorldContacts,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        let mut shares = vec![1.0_f64; bodies.len()];
        let mut is_shortened = vec![false; bodies.len()];
        for round in 0.. {
            let times = self.impact_times(contacts);
            self.selected.clear(bodies.len());
            for (n, time) in times.into_iter().enumerate() {
                if time.is_finite() && shares[n] > 0.0 && !bodies[n].is_asleep() {
                    let mut share = CONTACT_TIME * time;
                    if shares[n] * share < MIN_SHARE || round >= MAX_SHORTENINGS {
                        share = 0.0;
                    }
                    shares[n] *= share;
                    // A body that no correction has moved pays for its energy, too.
                    let body = &mut bodies[n];
                    self.energies[n].get_or_insert_with(|| body.energies(self.gravity));
                    body.shorten(share);
                    self.selected.insert(n);
                    is_shortened[n] = true;
                }
            }
            if self.selected.is_empty() {
                break;
            }
            self.impacts.find(bodies, contacts, &self.selected, false, observer)?;
            if self.impacts.is_empty() {
                break;
            }
        }
        self.shortened_bodies += is_shortened.iter().filter(|is_shortened| **is_shortened).count();
        Ok(())
    }

    /// Returns for each body the fraction of its motion after which it first meets another body, itself or the ground;
    /// infinite if it meets none.
    fn impact_times(&self, contacts: &WorldContacts) -> Vec<f64> {
        let mut times = vec![f64::INFINITY; contacts.ground.len()];
        for (bodies, impact) in &self.impacts.pairs {
            bodies.iter().for_each(|n| times[*n] = times[*n].min(impact.time));
        }
        for n in self.impacts.sinking.members() {
            times[n] = times[n].min(contacts.ground[n].sinks_after().unwrap_or(f64::INFINITY));
        }
        times
    }

    /// Moves corrected islands back to a part of their motion until their potential energy is at most their energy without
    /// contacts, plus their energy budgets.
    fn limit_potential(
        &mut self,
        bodies: &mut [Body],
        contacts: &mut WorldContacts,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        let mut at_start: Vec<usize> = Vec::new();
        for halving in 0.. {
            let Self { potential_limit, energies, selected, gravity, .. } = self;
            potential_limit.find_excess(bodies, &mut contacts.islands, *gravity, energies, selected);
            // At the beginning of the step, an excess is a rounding error.
            if self.selected.members().all(|n| at_start.contains(&n)) {
                break;
            }
            let share = if halving < MAX_HALVINGS { 0.5 } else { 0.0 };
            for n in self.selected.members() {
                bodies[n].shorten(share);
                self.shortened_bodies += 1;
            }
            if share == 0.0 {
                at_start.extend(self.selected.members());
            }
            self.impacts.find(bodies, contacts, &self.selected, false, observer)?;
            self.shorten(bodies, contacts, observer)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contacts::contact_laws::ContactLaws;
    use crate::contacts::ground_contacts::GroundContacts;
    use crate::test_shapes::tetrahedron;
    use crate::{Start, WorldOptions};

    /// The energy at the beginning of the step is given too low, as rounding may make it.
    #[test]
    fn bodies_at_the_beginning_of_their_step_move_back_no_farther() {
        let shape = tetrahedron(vec![DVec3::ZERO; 4], &[1.0]);
        let options = WorldOptions { ground: None, ..WorldOptions::default() };
        let start = Start { q: vec![1.0], ..Start::default() };
        let mut bodies = [Body::new(&shape, &start, &options, None).unwrap()];
        bodies[0].q[0] = 2.0;
        let mut contacts = WorldContacts::new(ContactLaws::new(&options, 1.0));
        contacts.ground.push(GroundContacts::default());
        contacts.islands.reset(1);
        let mut limiter = StepLimiter::new(DVec3::ZERO);
        limiter.energies = vec![Some([0.4; 2])];
        limiter.limit_potential(&mut bodies, &mut contacts, &mut ()).unwrap();
        assert_eq!((limiter.shortened_bodies, bodies[0].q[0]), (MAX_HALVINGS as usize + 1, 1.0));
    }
}
