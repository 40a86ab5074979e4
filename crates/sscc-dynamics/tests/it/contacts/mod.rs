//! Tests of contacts.

mod body_collisions;
mod friction;
mod ground_contacts;
mod restitution;
mod within_bodies;
