//! Parts of a step of a world: limits of the motion and of its energy, rolling friction, sleep, and the record of impulses.
//!
//! Each module takes the bodies and the contacts that it changes as arguments. The step itself is in `world.rs`.

pub(crate) mod divergence;
mod impact_contacts;
mod impacts;
pub(crate) mod impulses;
mod island_energy;
mod phases;
mod potential_limit;
pub(crate) mod rolling;
pub(crate) mod sleep;
pub(crate) mod step_limiter;

pub use phases::{Counts, Impulse, Observer, Phase};
