//! Record of the impulses of a step.

use glam::{DQuat, DVec3};

use super::phases::Impulse;
use crate::Body;
use crate::contacts::contact::Contact;
use crate::contacts::contact_constraint::{ContactPoints, GROUND, Source};

/// Appends the impulses that contacts exert on bodies. `of_contacts` has for each contact the impulse on its first body.
pub(crate) fn record<'c>(
    of_contacts: impl Iterator<Item = (&'c ContactPoints, DVec3)>,
    bodies: &[Body],
    contacts: &[Contact],
    impulses: &mut Vec<Impulse>,
) {
    for (points, impulse) in of_contacts.filter(|(_, impulse)| *impulse != DVec3::ZERO) {
        for (n, sign) in [(0, 1.0), (1, -1.0)] {
            if points.bodies[n] == GROUND {
                continue;
            }
            // A contact within one body gives an impulse at each of its two points.
            let number = points.bodies[n] as usize;
            let body = &bodies[number];
            let to_rest = if points.is_within() { DQuat::IDENTITY } else { body.rigid.orientation.inverse() };
            let (vertices, weights) = match points.source {
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
