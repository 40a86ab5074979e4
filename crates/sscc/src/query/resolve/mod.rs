//! A free configuration near a colliding one: a walk back towards it by projections on half-spaces.

mod answer;
mod batch;
mod counted;
mod projection;
#[allow(clippy::module_inception)] // named after its method, as all files here
mod resolve;
mod separations;
mod walk;

pub use answer::{ResolveOptions, Resolved};
pub use batch::FreeSamples;
