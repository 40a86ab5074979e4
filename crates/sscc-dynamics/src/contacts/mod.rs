//! Contacts of bodies with each other, with themselves and with the ground: where they are, how they begin and end, and the
//! impulses with which they act.
//!
//! Nothing here advances a body.

pub(crate) mod body_collisions;
pub(crate) mod contact;
pub(crate) mod contact_constraint;
mod contact_geometry;
pub(crate) mod contact_laws;
pub(crate) mod contact_set;
pub(crate) mod ground_contacts;
pub(crate) mod ground_point;
mod ground_points;
pub(crate) mod islands;
mod nearest_triangles;
mod recovery;
pub(crate) mod solver;
mod sweep_and_prune;
pub(crate) mod world_contacts;

pub use body_collisions::BodyPairs;
