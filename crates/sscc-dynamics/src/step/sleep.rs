//! Sleep: islands of bodies at rest sleep together, and wake together.

use crate::bodies::body_set::BodySet;
use crate::contacts::islands::PerIsland;
use crate::contacts::world_contacts::WorldContacts;
use crate::{Body, DynamicsError, WorldOptions};

/// Distance, as a share of a body's radius, within which all of its points stay while it is at rest.
const SLEEP_DISTANCE: f64 = 2e-2;

/// Wakes the sleeping bodies of a set, which contains whole islands, and locates their contacts.
pub(crate) fn wake(
    bodies: &mut [Body],
    contacts: &mut WorldContacts,
    set: &BodySet,
) -> Result<(), DynamicsError> {
    let mut woken = BodySet::default();
    woken.set(bodies.iter().zip(set.flags()).map(|(body, wakes)| *wakes && body.is_asleep()));
    if woken.is_empty() {
        return Ok(());
    }
    let WorldContacts { laws, ground, triangles, .. } = contacts;
    for n in woken.members() {
        let body = &mut bodies[n];
        (body.rest.is_asleep, body.rest.time) = (false, 0.0);
        body.save_trial();
        if let Some(plane) = &laws.ground {
            ground[n].begin(body, plane, laws)?;
        }
    }
    for contact in &mut triangles.list {
        let [a, b] = contact.bodies.map(|n| n as usize);
        if contact.is_rigid_constraint() && woken.contains(a) && woken.contains(b) {
            contact.locate([&bodies[a], &bodies[b]]);
            contact.min_gap = laws.kept_gap(contact.gap);
        }
    }
    Ok(())
}

/// Decides which islands fall asleep.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sleep {
    /// Whether all bodies of each island have been at rest for long enough.
    can_sleep: PerIsland<bool>,
    /// Whether the ground or a held body supports each island.
    is_supported: PerIsland<bool>,
}

impl Sleep {
    /// Puts islands to sleep whose bodies have been at rest for long enough.
    pub fn settle(&mut self, bodies: &mut [Body], contacts: &mut WorldContacts, options: &WorldOptions) {
        let WorldOptions { step, sleep, .. } = *options;
        if !sleep.time.is_finite() {
            return;
        }
        contacts.join_islands(bodies.len());
        let WorldContacts { ground, collisions, triangles, islands, .. } = contacts;
        let Self { can_sleep, is_supported } = self;
        can_sleep.reset(bodies.len(), true);
        is_supported.reset(bodies.len(), false);
        for (n, body) in bodies.iter_mut().enumerate() {
            if !body.is_asleep() {
                let distance = sleep.distance.unwrap_or_else(|| SLEEP_DISTANCE * body.shape().radius());
                body.measure_rest(step, distance);
            }
            let island = islands.of(n);
            can_sleep[island] &= body.rest.time >= sleep.time && body.pairs.is_empty();
            is_supported[island] |= ground[n].count > 0;
        }
        for found in collisions.colliding() {
            found.bodies.iter().for_each(|n| can_sleep[islands.of(*n)] = false);
        }
        for contact in &triangles.list {
            let is_held = |n: &u32| !bodies[*n as usize].is_free();
            is_supported[islands.of(contact.bodies[0] as usize)] |= contact.bodies.iter().any(is_held);
        }
        for (n, body) in bodies.iter_mut().enumerate() {
            let island = islands.of(n);
            if can_sleep[island] && is_supported[island] && !body.is_asleep() {
                body.rest.is_asleep = true;
                body.scale_velocities(0.0);
                body.save_start();
                collisions.forget_motion(n);
            }
        }
    }
}
