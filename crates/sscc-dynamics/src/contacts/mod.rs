//! Contacts of bodies with each other, with themselves and with the ground: their geometry, how they begin and end, and their
//! impulses.
//!
//! No function in this folder advances a body in time.

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
