//! Sleep: islands of bodies at rest sleep together, and wake together.

use crate::step_buffers::StepBuffers;
use crate::{DynamicsError, World};

/// Distance, as a share of a body's radius, within which all of its points stay while it is at rest.
const SLEEP_DISTANCE: f64 = 2e-2;

impl World {
    /// Joins bodies in contact to islands.
    pub(crate) fn join_islands(&mut self) {
        self.islands.reset(self.bodies.len());
        for contact in &self.contacts.list {
            let [a, b] = contact.bodies.map(|n| n as usize);
            self.islands.join(a, b);
        }
    }

    /// Wakes the sleeping ones of some bodies, which contain whole islands, and locates their contacts.
    pub(crate) fn wake(&mut self, bodies: &[bool]) -> Result<(), DynamicsError> {
        let woken: Vec<bool> =
            self.bodies.iter().zip(bodies).map(|(body, wakes)| *wakes && body.is_asleep()).collect();
        if !woken.contains(&true) {
            return Ok(());
        }
        for n in (0..woken.len()).filter(|n| woken[*n]) {
            let rest = &mut self.bodies[n].rest;
            (rest.is_asleep, rest.time) = (false, 0.0);
            self.bodies[n].save_trial();
            if let Some(options) = self.ground_options() {
                let contacts = &mut self.ground_contacts[n];
                contacts.update(&mut self.bodies[n], &options)?;
                contacts.begin(&self.bodies[n], &options.ground, &self.rigid_contacts);
            }
        }
        for contact in &mut self.contacts.list {
            let [a, b] = contact.bodies.map(|n| n as usize);
            if contact.is_rigid_constraint() && woken[a] && woken[b] {
                contact.locate([&self.bodies[a], &self.bodies[b]]);
                contact.min_gap = self.rigid_contacts.kept_gap(contact.gap);
            }
        }
        Ok(())
    }

    /// Puts islands to sleep whose bodies have been at rest for long enough.
    pub(crate) fn settle(&mut self) {
        let sleep = self.options.sleep;
        let count = self.bodies.len();
        if !sleep.time.is_finite() {
            return;
        }
        self.join_islands();
        let StepBuffers { can_sleep, is_supported, .. } = &mut self.buffers;
        can_sleep.clear();
        can_sleep.resize(count, true);
        is_supported.clear();
        is_supported.resize(count, false);
        for n in 0..count {
            let body = &mut self.bodies[n];
            let distance = sleep.distance.unwrap_or_else(|| SLEEP_DISTANCE * body.shape().radius());
            if !body.is_asleep() {
                let (shape, step) = (&body.shape, self.options.step);
                let bend_bound = |change: &[f64]| body.posed.displacement_bound(change);
                body.rest.update(shape, &body.rigid, &body.q, (step, distance), bend_bound);
            }
            let island = self.islands.of(n);
            let body = &self.bodies[n];
            can_sleep[island] &= body.rest.time >= sleep.time && body.pairs.is_empty();
            is_supported[island] |= self.ground_contacts[n].count > 0;
        }
        for found in self.body_collisions.colliding() {
            found.bodies.iter().for_each(|n| can_sleep[self.islands.of(*n)] = false);
        }
        for contact in &self.contacts.list {
            let held = |n: &u32| !self.bodies[*n as usize].is_free();
            is_supported[self.islands.of(contact.bodies[0] as usize)] |= contact.bodies.iter().any(held);
        }
        for n in 0..count {
            let island = self.islands.of(n);
            let body = &mut self.bodies[n];
            if can_sleep[island] && is_supported[island] && !body.is_asleep() {
                body.rest.is_asleep = true;
                body.scale_velocities(0.0);
                body.save_start();
                self.body_collisions.forget_motion(n);
            }
        }
    }
}
