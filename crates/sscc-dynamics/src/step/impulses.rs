//! Record of the impulses of a step.

use glam::{DQuat, DVec3};

use super::phases::Impulse;
use crate::Body;
use crate::contacts::contact::Contact;
use crate::contacts::contact_constraint::{GROUND, Source};

/// Impulse of a contact: its bodies, its source, and the impulse on the first body.
pub(crate) type ContactImpulse = ([u32; 2], Source, DVec3);

/// Appends the impulses on the bodies of contacts.
pub(crate) fn record(
    of_contacts: impl Iterator<Item = ContactImpulse>,
    bodies: &[Body],
    contacts: &[Contact],
    impulses: &mut Vec<Impulse>,
) {
    for (numbers, source, impulse) in of_contacts.filter(|(.., impulse)| *impulse != DVec3::ZERO) {
        for (n, sign) in [(0, 1.0), (1, -1.0)] {
            if numbers[n] == GROUND {
                continue;
            }
            // A contact within one body gives an impulse at each of its two points.
            let number = numbers[n] as usize;
            let body = &bodies[number];
            let is_within = numbers[0] == numbers[1];
            let to_rest = if is_within { DQuat::IDENTITY } else { body.rigid.orientation.inverse() };
            let (vertices, weights) = match source {
                Source::Vertex(v) => ([v; 3], [1.0, 0.0, 0.0]),
                Source::Contact(contact) => {
                    let anchor = &contacts[contact as usize].anchors[n];
                    (body.shape().model().mesh().faces()[anchor.triangle as usize], anchor.weights)
                }
            };
            impulses.push(Impulse { body: number, vertices, weights, impulse: to_rest * impulse * sign });
        }
    }
}
