//! The search for a free configuration near a colliding one: from a free start towards it by projections on half-spaces.

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
