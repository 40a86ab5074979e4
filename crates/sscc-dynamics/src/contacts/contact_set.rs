//! Set of all triangle contacts of a world: begins, keeps and ends contacts, and makes contact constraints of them.

use std::collections::HashSet;

use glam::DVec3;
use sscc::Pair;

use super::body_collisions::{BodyCollisions, BodyPairs};
use super::contact::Contact;
use super::contact_constraint::{ContactConstraint, ContactPoints, Source};
use super::contact_laws::ContactLaws;
use super::nearest_triangles::{Nearest, nearest_features};
use crate::Body;

/// Contacts between triangles, kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactSet {
    /// Sorted by [`Contact::key`], except for the contacts at the end that began after the beginning of the current
    /// step.
    pub list: Vec<Contact>,
    /// Number of contacts at the beginning of this step; the list is sorted up to here.
    sorted: usize,
    /// Ended contacts, whose memory new contacts reuse.
    spare: Vec<Contact>,
    /// Rigid contacts of the last step, sorted, which are needed while the contacts of this step begin.
    old: Vec<Contact>,
    found: Vec<Nearest>,
    /// Rounded points of the rigid contacts of this step.
    points: HashSet<([u32; 2], [i64; 3], [i64; 3])>,
}

/// Added to the features of contacts that impacts began: see [`Contact::features`].
const IMPACT: u8 = 16;

/// Points are rounded to multiples of this share of the skin. Contacts with equal rounded points are duplicates.
const POINT_SIZE: f64 = 1e-4;

impl ContactSet {
    /// Ends contacts that opened, and begins contacts of collisions between bodies, and within them if the laws require it.
    /// The geometry of a pair that has collided for the laws' `max_age` steps is computed again.
    pub fn update(&mut self, bodies: &[Body], collisions: &BodyCollisions, laws: &ContactLaws) {
        let ContactLaws { skin, max_age, .. } = *laws;
        self.old.clear();
        let mut kept = 0;
        for n in 0..self.list.len() {
            let contact = &mut self.list[n];
            let both = contact.bodies.map(|body| &bodies[body as usize]);
            let lasts = if both.iter().all(|body| body.is_asleep()) {
                true
            } else if contact.is_rigid {
                false
            } else {
                let slip = contact.update_gap(both);
                contact.gap < MAX_GAP * skin && slip < contact.max_slip
            };
            if lasts {
                self.list.swap(kept, n);
                kept += 1;
            }
        }
        for contact in self.list.drain(kept..) {
            if contact.is_rigid { &mut self.old } else { &mut self.spare }.push(contact);
        }
        self.old.sort_unstable_by_key(Contact::key);
        self.points.clear();
        let mut last = None;
        for n in 0..self.old.len() {
            let (numbers, pair, _) = self.old[n].key();
            if last != Some((numbers, pair)) {
                last = Some((numbers, pair));
                let both = numbers.map(|body| &bodies[body as usize]);
                self.begin_near(numbers, pair, both, skin);
            }
        }
        self.spare.append(&mut self.old);
        self.list[..kept].sort_unstable_by_key(Contact::key);
        let own = bodies.iter().enumerate().map(|(n, body)| BodyPairs { bodies: [n, n], pairs: &body.pairs });
        let all =
            own.filter(|own| laws.act_within_bodies() && !own.pairs.is_empty()).chain(collisions.colliding());
        for BodyPairs { bodies: numbers, pairs } in all {
            let [a, b] = numbers.map(|n| &bodies[n]);
            if a.is_asleep() && b.is_asleep() {
                continue;
            }
            let indices = numbers.map(|n| n as u32);
            for &(i, j) in pairs {
                let known = self.list[..kept].binary_search_by_key(&(indices, (i, j), 0), Contact::key);
                if let Ok(at) = known {
                    self.list[at].age += 1;
                    if self.list[at].age < max_age {
                        continue;
                    }
                }
                let corners = if indices[0] == indices[1] {
                    [i, j].map(|t| a.corners(t))
                } else {
                    [a.world_corners(i), b.world_corners(j)]
                };
                if let Ok(at) = known {
                    self.list[at].begin(indices, (i, j), [a, b], corners);
                    continue;
                }
                let mut contact = self.spare.pop().unwrap_or_default();
                contact.preload = 0.0;
                (contact.normal_impulse, contact.friction_impulse) = (0.0, DVec3::ZERO);
                let is_contact = contact.begin(indices, (i, j), [a, b], corners);
                if is_contact { &mut self.list } else { &mut self.spare }.push(contact);
            }
        }
        self.list.sort_unstable_by_key(Contact::key);
        self.sorted = self.list.len();
    }

    /// Appends the rigid contacts of two triangles at the beginning of the step, if they are near. Contacts of `old` with
    /// the same features pass on their impulses.
    pub fn begin_near(&mut self, indices: [u32; 2], pair: Pair, bodies: [&Body; 2], skin: f64) {
        let is_within = indices[0] == indices[1];
        let corners =
            [bodies[0].start_corners(pair.0, is_within), bodies[1].start_corners(pair.1, is_within)];
        nearest_features(&corners[0], &corners[1], MAX_GAP * skin, &mut self.found);
        let found = std::mem::take(&mut self.found);
        let is_near = |one: &Nearest| one.points[0].distance(one.points[1]) < MAX_GAP * skin;
        if found.first().is_some_and(is_near) {
            let size = skin * POINT_SIZE;
            for (n, nearest) in found.iter().enumerate() {
                let [x, y] = nearest.points.map(|x| (x / size).round().to_array().map(|x| x as i64));
                let is_duplicate = !self.points.insert((indices, x, y));
                // The first contact is kept, because it shows that the pair has contacts.
                if is_duplicate && n > 0 {
                    continue;
                }
                let mut contact = self.spare.pop().unwrap_or_default();
                contact.begin_rigid(indices, pair, bodies, &corners, nearest, is_duplicate);
                for features in [nearest.features, nearest.features + IMPACT] {
                    let key = (indices, pair, features);
                    if let Ok(at) = self.old.binary_search_by_key(&key, Contact::key) {
                        let old = &self.old[at];
                        contact.normal_impulse += old.normal_impulse;
                        contact.friction_impulse += old.friction_impulse;
                    }
                }
                self.list.push(contact);
            }
        }
        self.found = found;
    }

    /// Returns the contacts that began in this step, after its beginning.
    pub fn new_contacts(&self) -> &[Contact] {
        &self.list[self.sorted..]
    }

    /// Whether these triangles have a rigid contact since the beginning of the step.
    pub fn has_rigid(&self, indices: [u32; 2], pair: Pair) -> bool {
        let before = &self.list[..self.sorted];
        let at = before.partition_point(|contact| contact.key() < (indices, pair, 1));
        before.get(at).is_some_and(|contact| contact.is_of(indices, pair))
    }

    /// Whether these triangles have a contact that began in this step, after its beginning.
    pub fn has_begun(&self, indices: [u32; 2], pair: Pair) -> bool {
        self.new_contacts().iter().any(|contact| contact.is_of(indices, pair))
    }

    /// Begins a rigid contact of the nearest points of two triangles whose corners in the world are `corners`, or moves the
    /// contact that the same features began earlier in this step. Returns the contact, with the distance of its points, or
    /// None if no direction separates the triangles.
    pub fn begin_impact(
        &mut self,
        indices: [u32; 2],
        pair: Pair,
        bodies: [&Body; 2],
        corners: &[[DVec3; 3]; 2],
    ) -> Option<(&mut Contact, f64)> {
        nearest_features(&corners[0], &corners[1], 0.0, &mut self.found);
        let mut nearest = *self.found.first()?;
        nearest.features += IMPACT;
        let key = (indices, pair, nearest.features);
        let known = self.new_contacts().iter().position(|contact| contact.key() == key);
        let at = known.map_or(self.list.len(), |n| self.sorted + n);
        if known.is_none() {
            self.list.push(self.spare.pop().unwrap_or_default());
        }
        let contact = &mut self.list[at];
        let impulse = if known.is_some() { contact.normal_impulse } else { 0.0 };
        contact.begin_rigid(indices, pair, bodies, corners, &nearest, false);
        contact.normal_impulse = impulse;
        let [x, y] = nearest.points;
        Some((contact, x.distance(y)))
    }

    /// Sorts the contacts that began in this step into the list.
    pub fn end_step(&mut self) {
        if self.list.len() > self.sorted {
            self.list.sort_by_key(Contact::key);
        }
    }

    /// Updates the preload of each soft contact of a body that is awake, and appends the contact's constraint of this step
    /// to `constraints`.
    pub fn add_constraints(
        &mut self,
        bodies: &[Body],
        laws: &ContactLaws,
        constraints: &mut Vec<ContactConstraint>,
    ) {
        let ContactLaws { skin, preload_rate, friction, .. } = *laws;
        for (n, contact) in self.list.iter_mut().enumerate() {
            let both = contact.bodies.map(|body| &bodies[body as usize]);
            if contact.is_rigid || both.iter().all(|body| body.is_asleep()) {
                continue;
            }
            contact.preload = adapt_preload(contact.preload, contact.gap, skin, preload_rate);
            let [a, b] = both;
            let mut points = ContactPoints {
                bodies: contact.bodies,
                source: Source::Contact(n as u32),
                normal: contact.normal,
                arms: [DVec3::ZERO; 2],
            };
            if !contact.is_within() {
                points.normal = b.rigid.orientation * contact.normal;
                let [x, y] = contact.world_points([a, b]);
                let middle = (x + y) * 0.5;
                points.arms = [middle - a.rigid.position, middle - b.rigid.position];
            }
            constraints.push(ContactConstraint {
                points,
                compression: skin - contact.gap + contact.preload,
                modal_inverse_mass: contact.modal_inverse_mass,
                friction,
                normal_impulse: 0.0,
                friction_impulse: DVec3::ZERO,
            });
        }
    }
}

/// Gap, in skins, at which a contact ends. It exceeds 1: a contact whose spring throws a point slightly farther than
/// the skin continues when the point returns.
const MAX_GAP: f64 = 3.0;

/// Maximum preload, in skins.
const MAX_PRELOAD: f64 = 100.0;

/// Returns the preload for the next step. A load compresses the spring. The preload therefore grows slowly while the
/// gap is less than half the skin, so that resting bodies do not touch, and shrinks slowly while the gap is larger.
fn adapt_preload(preload: f64, gap: f64, skin: f64, preload_rate: f64) -> f64 {
    (preload + preload_rate * (skin / 2.0 - gap).min(skin)).clamp(0.0, MAX_PRELOAD * skin)
}
