//! Impacts of a motion: pairs of triangles, of different bodies or of one body, that meet during the motion, and bodies that
//! sink into the ground.

use rayon::prelude::*;
use sscc::Impact;

use super::phases::{Observer, Phase};
use crate::bodies::body_set::BodySet;
use crate::contacts::ground_contacts::GroundContacts;
use crate::contacts::world_contacts::WorldContacts;
use crate::error::first_error;
use crate::{Body, DynamicsError, Response};

/// Impacts in the motion of some bodies from the beginning of the step to their current state.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impacts {
    /// Pairs of triangles that meet, with the numbers of their bodies.
    pub pairs: Vec<([usize; 2], Impact)>,
    /// Bodies that sink into the ground, or come so near to it that they need more points there.
    pub sinking: BodySet,
}

impl Impacts {
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty() && self.sinking.is_empty()
    }

    /// Finds the impacts of the selected bodies. With `makes_points`, the lowest vertices of sinking bodies become points on
    /// the ground.
    pub fn find(
        &mut self,
        bodies: &mut [Body],
        contacts: &mut WorldContacts,
        selected: &BodySet,
        makes_points: bool,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        self.pairs.clear();
        if bodies.len() > 1 {
            contacts.collisions.find_impacts(bodies, selected)?;
            let found = contacts.collisions.impacts();
            self.pairs.extend(found.flat_map(|(bodies, all)| all.iter().map(move |one| (bodies, *one))));
        }
        if contacts.laws.response == Response::Contact {
            self.find_within(bodies, selected, observer)?;
        }
        self.find_sinking(bodies, contacts, selected, makes_points)
    }

    /// Finds the impacts of the selected bodies with themselves.
    fn find_within(
        &mut self,
        bodies: &mut [Body],
        selected: &BodySet,
        observer: &mut impl Observer,
    ) -> Result<(), DynamicsError> {
        // A comparison answers all others.
        let is_uncertain = selected.members().any(|n| !bodies[n].is_root_certified());
        if is_uncertain {
            observer.enter(Phase::SelfCollision);
        }
        let find = |(body, is_selected): (&mut Body, &bool)| {
            if *is_selected { body.find_own_impacts() } else { Ok(()) }
        };
        match (&mut *bodies, selected.flags()) {
            ([body], [is_selected]) => find((body, is_selected))?,
            (bodies, flags) => first_error(bodies.par_iter_mut().zip(flags).map(find).collect())?,
        }
        for n in selected.members() {
            self.pairs.extend(bodies[n].impacts.iter().map(|one| ([n, n], *one)));
        }
        if is_uncertain {
            observer.enter(if bodies.len() > 1 { Phase::InterObject } else { Phase::Dynamics });
        }
        Ok(())
    }

    /// Finds the selected bodies that sink into the ground.
    fn find_sinking(
        &mut self,
        bodies: &mut [Body],
        contacts: &mut WorldContacts,
        selected: &BodySet,
        makes_points: bool,
    ) -> Result<(), DynamicsError> {
        self.sinking.clear(bodies.len());
        let WorldContacts { laws, ground: contacts, .. } = contacts;
        let Some(ground) = &laws.ground else { return Ok(()) };
        type Sinking<'s> = ((&'s bool, &'s mut bool), (&'s mut Body, &'s mut GroundContacts));
        let find = |((is_selected, sinks), (body, contacts)): Sinking<'_>| {
            if *is_selected {
                contacts.update(body, ground, laws.skin)?;
                let is_near = makes_points && contacts.add_sinking(body, ground, laws);
                *sinks = is_near || contacts.sinks_after().is_some();
            }
            Ok(())
        };
        let flags = (selected.flags(), self.sinking.flags_mut());
        match (bodies, &mut contacts[..], flags) {
            ([body], [contacts], ([is_selected], [sinks])) => find(((is_selected, sinks), (body, contacts))),
            (bodies, contacts, (selected, sinks)) => {
                let all = bodies.par_iter_mut().zip(contacts);
                first_error(selected.par_iter().zip(sinks).zip(all).map(find).collect())
            }
        }
    }
}
