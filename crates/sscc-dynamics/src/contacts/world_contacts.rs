//! All contacts of a world: of each body with the ground, between bodies, and within them.

use rayon::prelude::*;

use super::body_collisions::BodyCollisions;
use super::contact_constraint::Source;
use super::contact_laws::ContactLaws;
use super::contact_set::ContactSet;
use super::ground_contacts::GroundContacts;
use super::islands::{Islands, PerIsland};
use super::solver::correction::Correction;
use crate::error::first_error;
use crate::{Body, DynamicsError};

/// All contacts of a world, kept from step to step.
#[derive(Clone, Debug)]
pub(crate) struct WorldContacts {
    pub laws: ContactLaws,
    /// Contacts of each body with the ground.
    pub ground: Vec<GroundContacts>,
    pub collisions: BodyCollisions,
    /// Contacts between triangles.
    pub triangles: ContactSet,
    pub islands: Islands,
    /// For each island the energy that the recovery of all gaps costs, and the sum of the budgets of its bodies.
    pub(super) recovery: PerIsland<[f64; 2]>,
}

impl WorldContacts {
    /// Returns the contacts of a world without bodies.
    pub fn new(laws: ContactLaws) -> Self {
        Self {
            laws,
            ground: Vec::new(),
            collisions: BodyCollisions::default(),
            triangles: ContactSet::default(),
            islands: Islands::default(),
            recovery: PerIsland::default(),
        }
    }

    /// Begins the contacts of a step with the ground: finds the vertices near it of all bodies that are awake.
    pub fn begin_ground(&mut self, bodies: &mut [Body]) -> Result<(), DynamicsError> {
        let laws = &self.laws;
        let Some(ground) = laws.ground else { return Ok(()) };
        let update = |(body, contacts): (&mut Body, &mut GroundContacts)| {
            if body.is_asleep() { Ok(()) } else { contacts.begin(body, &ground, laws) }
        };
        match (bodies, &mut self.ground[..]) {
            ([body], [contacts]) => update((body, contacts)),
            (bodies, contacts) => first_error(bodies.par_iter_mut().zip(contacts).map(update).collect()),
        }
    }

    /// Begins the contacts of a step between triangles, and joins their bodies to islands.
    pub fn begin_triangles(&mut self, bodies: &[Body]) {
        self.triangles.update(bodies, &self.collisions, &self.laws);
        self.join_islands(bodies.len());
    }

    /// Joins bodies in contact to islands.
    pub fn join_islands(&mut self, bodies: usize) {
        self.islands.reset(bodies);
        for contact in &self.triangles.list {
            let [a, b] = contact.bodies.map(|n| n as usize);
            self.islands.join(a, b);
        }
    }

    /// Stores the impulses of corrections in their contacts.
    pub fn keep_impulses(&mut self, corrections: &[Correction]) {
        for one in corrections {
            let (normal_impulse, friction_impulse) = (one.normal_impulse, one.friction_impulse);
            match one.points.source {
                Source::Contact(contact) => {
                    let contact = &mut self.triangles.list[contact as usize];
                    (contact.normal_impulse, contact.friction_impulse) = (normal_impulse, friction_impulse);
                }
                Source::Vertex(vertex) => {
                    let contacts = &mut self.ground[one.points.bodies[0] as usize];
                    if let Ok(n) = contacts.find(vertex) {
                        let point = &mut contacts.points[n];
                        (point.normal_impulse, point.friction_impulse) = (normal_impulse, friction_impulse);
                    }
                }
            }
        }
    }
}
