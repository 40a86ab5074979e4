//! Set of all triangle contacts of a world: begins, keeps and ends contacts, and turns them into contact constraints.

use glam::DVec3;

use crate::body::Body;
use crate::contact::Contact;
use crate::detect::{BodyPairs, Neighbours};
use crate::solve::{Source, Touch};

/// Contacts between triangles, kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Contacts {
    /// Sorted by [`Contact::key`].
    pub list: Vec<Contact>,
    /// Ended contacts, whose memory new contacts reuse.
    spare: Vec<Contact>,
}

impl Contacts {
    /// Ends contacts that opened, and begins contacts of new collisions. `within` selects whether collisions within a
    /// body make contacts. The geometry of a pair that collides in `max_age` steps is computed again.
    pub fn update(
        &mut self,
        bodies: &[Body<'_>],
        within: bool,
        neighbours: &Neighbours,
        skin: f64,
        patience: u32,
    ) {
        let mut kept = 0;
        for n in 0..self.list.len() {
            let contact = &mut self.list[n];
            let slid = contact.measure(contact.bodies.map(|body| &bodies[body as usize]));
            if contact.gap < LOST * skin && slid < contact.slack {
                self.list.swap(kept, n);
                kept += 1;
            }
        }
        self.spare.extend(self.list.drain(kept..));
        let own = bodies.iter().enumerate().map(|(n, body)| BodyPairs { bodies: [n, n], pairs: &body.pairs });
        let found = own.filter(|own| within && !own.pairs.is_empty()).chain(neighbours.colliding());
        for BodyPairs { bodies: met, pairs } in found {
            let [a, b] = met.map(|n| &bodies[n]);
            let indices = met.map(|n| n as u32);
            for &(i, j) in pairs {
                let known = self.list[..kept].binary_search_by_key(&(indices, (i, j)), Contact::key);
                if let Ok(at) = known {
                    self.list[at].age += 1;
                    if self.list[at].age < patience {
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
                let is_one = contact.begin(indices, (i, j), [a, b], corners);
                if is_one { &mut self.list } else { &mut self.spare }.push(contact);
            }
        }
        if self.list.len() > kept {
            self.list.sort_unstable_by_key(Contact::key);
        }
    }

    /// Adds what they are in this step.
    pub fn touch(
        &mut self,
        bodies: &[Body<'_>],
        skin: f64,
        creep: f64,
        friction: f64,
        touches: &mut Vec<Touch>,
    ) {
        for (n, contact) in self.list.iter_mut().enumerate() {
            contact.preload = adapted(contact.preload, contact.gap, skin, creep);
            let [a, b] = contact.bodies.map(|body| &bodies[body as usize]);
            let mut touch = Touch {
                bodies: contact.bodies,
                source: Source::Contact(n as u32),
                normal: contact.normal,
                arms: [DVec3::ZERO; 2],
                depth: skin - contact.gap + contact.preload,
                mobility: contact.mobility,
                friction,
                pressure: 0.0,
                drag: DVec3::ZERO,
            };
            if !contact.is_within() {
                touch.normal = b.rigid.orientation * contact.normal;
                let [x, y] = contact.places([a, b]);
                let middle = (x + y) * 0.5;
                touch.arms = [middle - a.rigid.position, middle - b.rigid.position];
            }
            touches.push(touch);
        }
    }
}

/// A contact ends beyond so many skins: what its spring throws a little farther than the skin falls back on it.
const LOST: f64 = 3.0;

/// By how many skins a spring may be longer than its skin.
const MOST_PRELOAD: f64 = 100.0;

/// Returns the preload for the next step. A load compresses the spring; the preload therefore grows slowly while the
/// gap is less than half the skin, so that resting bodies stay apart.
pub(crate) fn adapted(preload: f64, gap: f64, skin: f64, creep: f64) -> f64 {
    (preload + creep * (skin / 2.0 - gap).min(skin)).clamp(0.0, MOST_PRELOAD * skin)
}
