//! Contacts of impacts: the triangles that meet during a step, and those near them, become rigid contacts.

use glam::DVec3;
use sscc::{Impact, Pair};

use super::sleep::wake;
use crate::bodies::body_set::BodySet;
use crate::contacts::body_collisions::BodyCollisions;
use crate::contacts::world_contacts::WorldContacts;
use crate::{Body, DynamicsError};

/// Fraction of the time of impact at which the triangles are still apart. The geometry of a contact is computed there, and
/// bodies that no correction keeps apart move only so far.
pub(crate) const CONTACT_TIME: f64 = 0.9;

/// Distance, in skins, within which triangles near an impact make contacts.
const NEAR_MARGIN: f64 = 2.0;

/// Makes contacts of impacts.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImpactContacts {
    /// Pairs of triangles near the impacts of the current correction, with their bodies.
    near: Vec<([usize; 2], Pair)>,
    /// Pairs of bodies whose near pairs were already collected in this step.
    gathered: Vec<[usize; 2]>,
}

impl ImpactContacts {
    /// Begins a step.
    pub fn begin_step(&mut self) {
        self.gathered.clear();
    }

    /// Makes contacts of impacts and of triangles near them. `selected` are the bodies of their islands.
    pub fn begin(
        &mut self,
        bodies: &mut [Body],
        contacts: &mut WorldContacts,
        impacts: &[([usize; 2], Impact)],
        selected: &BodySet,
    ) -> Result<(), DynamicsError> {
        let at_impacts: Vec<_> = impacts.iter().map(|one| corners_at_impact(bodies, one)).collect();
        self.find_near(bodies, contacts, impacts)?;
        wake(bodies, contacts, selected)?;
        let WorldContacts { laws, triangles, .. } = contacts;
        let first = triangles.list.len();
        for (numbers, pair) in &self.near {
            let bodies = numbers.map(|n| &bodies[n]);
            triangles.begin_near(numbers.map(|n| n as u32), *pair, bodies, laws.skin);
        }
        for contact in &mut triangles.list[first..] {
            contact.min_gap = laws.kept_gap(contact.gap);
        }
        for ((numbers, impact), corners) in impacts.iter().zip(&at_impacts) {
            let (indices, bodies) = (numbers.map(|n| n as u32), numbers.map(|n| &bodies[n]));
            if let Some((contact, distance)) = triangles.begin_impact(indices, impact.pair, bodies, corners) {
                contact.min_gap = laws.kept_gap(distance);
            }
        }
        Ok(())
    }

    /// Finds the pairs of triangles near impacts that have no contact. Without them, other triangles near the impacts would
    /// be found only in later corrections.
    fn find_near(
        &mut self,
        bodies: &mut [Body],
        contacts: &WorldContacts,
        impacts: &[([usize; 2], Impact)],
    ) -> Result<(), DynamicsError> {
        let Self { near, gathered } = self;
        let WorldContacts { laws, triangles, .. } = contacts;
        near.clear();
        for (numbers, _) in impacts {
            if numbers[0] != numbers[1] && !gathered.contains(numbers) {
                gathered.push(*numbers);
                BodyCollisions::find_near(bodies, *numbers, NEAR_MARGIN * laws.skin, near)?;
            }
        }
        near.extend(
            impacts.iter().filter(|(numbers, _)| numbers[0] == numbers[1]).map(|(n, one)| (*n, one.pair)),
        );
        near.retain(|(numbers, pair)| {
            let indices = numbers.map(|n| n as u32);
            // A pair of one body may meet again after a correction. Pairs of two bodies are gathered once.
            let has_begun = numbers[0] == numbers[1] && triangles.has_begun(indices, *pair);
            !has_begun && !triangles.has_rigid(indices, *pair)
        });
        Ok(())
    }
}

/// Returns the corners of the triangles of an impact shortly before they meet: in axes of the rest pose for an impact of a body
/// with itself, else of the world.
fn corners_at_impact(bodies: &[Body], ([a, b], impact): &([usize; 2], Impact)) -> [[DVec3; 3]; 2] {
    let of = |body: &Body, triangle: u32| {
        let [t0, t1] = match &body.swept {
            _ if a == b => [body.start_corners(triangle, true), body.corners(triangle)],
            Some(swept) => swept.corners(triangle),
            None => [body.world_corners(triangle); 2],
        };
        let time = impact.time * CONTACT_TIME;
        std::array::from_fn(|n| t0[n].lerp(t1[n], time))
    };
    [of(&bodies[*a], impact.pair.0), of(&bodies[*b], impact.pair.1)]
}
