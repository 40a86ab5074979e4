//! Set of all triangle contacts of a world: begins, keeps and ends contacts, and turns them into contact constraints.

use glam::DVec3;

use crate::body::Body;
use crate::body_collisions::{BodyCollisions, BodyPairs};
use crate::contact::Contact;
use crate::contact_constraint::{ContactConstraint, Source};

/// Contacts between triangles, kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactSet {
    /// Sorted by [`Contact::key`].
    pub list: Vec<Contact>,
    /// Ended contacts, whose memory new contacts reuse.
    spare: Vec<Contact>,
}

impl ContactSet {
    /// Ends contacts that opened, and begins contacts of new collisions. `within` selects whether collisions within a
    /// body make contacts. The geometry of a pair that collides in `max_age` steps is computed again.
    pub fn update(
        &mut self,
        bodies: &[Body<'_>],
        within: bool,
        collisions: &BodyCollisions,
        skin: f64,
        max_age: u32,
    ) {
        let mut kept = 0;
        for n in 0..self.list.len() {
            let contact = &mut self.list[n];
            let slip = contact.update_gap(contact.bodies.map(|body| &bodies[body as usize]));
            if contact.gap < MAX_GAP * skin && slip < contact.max_slip {
                self.list.swap(kept, n);
                kept += 1;
            }
        }
        self.spare.extend(self.list.drain(kept..));
        let own = bodies.iter().enumerate().map(|(n, body)| BodyPairs { bodies: [n, n], pairs: &body.pairs });
        let all = own.filter(|own| within && !own.pairs.is_empty()).chain(collisions.colliding());
        for BodyPairs { bodies: numbers, pairs } in all {
            let [a, b] = numbers.map(|n| &bodies[n]);
            let indices = numbers.map(|n| n as u32);
            for &(i, j) in pairs {
                let known = self.list[..kept].binary_search_by_key(&(indices, (i, j)), Contact::key);
                if let Ok(at) = known {
                    self.list[at].age += 1;
                    if self.list[at].age < max_age {
                        continue;
                    }
                }
                let corners = if indices[0] == indices[1] {
                    [i, j].map(|t| a.corners(t))
                } else {
                    [a.posed.corners(i), b.posed.corners(j)]
                };
                if let Ok(at) = known {
                    self.list[at].begin(indices, (i, j), [a, b], corners);
                    continue;
                }
                let mut contact = self.spare.pop().unwrap_or_default();
                contact.preload = 0.0;
                let is_contact = contact.begin(indices, (i, j), [a, b], corners);
                if is_contact { &mut self.list } else { &mut self.spare }.push(contact);
            }
        }
        if self.list.len() > kept {
            self.list.sort_unstable_by_key(Contact::key);
        }
    }

    /// Updates the preload of each contact, and appends the contact's constraint of this step to `constraints`.
    pub fn add_constraints(
        &mut self,
        bodies: &[Body<'_>],
        skin: f64,
        preload_rate: f64,
        friction: f64,
        constraints: &mut Vec<ContactConstraint>,
    ) {
        for (n, contact) in self.list.iter_mut().enumerate() {
            contact.preload = adapt_preload(contact.preload, contact.gap, skin, preload_rate);
            let [a, b] = contact.bodies.map(|body| &bodies[body as usize]);
            let mut constraint = ContactConstraint {
                bodies: contact.bodies,
                source: Source::Contact(n as u32),
                normal: contact.normal,
                arms: [DVec3::ZERO; 2],
                compression: skin - contact.gap + contact.preload,
                modal_inverse_mass: contact.modal_inverse_mass,
                friction,
                normal_impulse: 0.0,
                friction_impulse: DVec3::ZERO,
            };
            if !contact.is_within() {
                constraint.normal = b.rigid.orientation * contact.normal;
                let [x, y] = contact.world_points([a, b]);
                let middle = (x + y) * 0.5;
                constraint.arms = [middle - a.rigid.position, middle - b.rigid.position];
            }
            constraints.push(constraint);
        }
    }
}

/// Gap, in skins, beyond which a contact ends. It exceeds 1, so that a contact whose spring throws a point a little
/// farther than the skin does not begin anew when the point returns.
const MAX_GAP: f64 = 3.0;

/// Maximum preload, in skins.
const MAX_PRELOAD: f64 = 100.0;

/// Returns the preload for the next step. A load compresses the spring; the preload therefore grows slowly while the
/// gap is less than half the skin, so that resting bodies stay apart.
pub(crate) fn adapt_preload(preload: f64, gap: f64, skin: f64, preload_rate: f64) -> f64 {
    (preload + preload_rate * (skin / 2.0 - gap).min(skin)).clamp(0.0, MAX_PRELOAD * skin)
}
