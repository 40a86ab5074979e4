//! The narrow phase: the test of two triangles whose boxes overlap. There are three:
//!
//! - discrete ([`DiscreteHits`]): whether they have a point in common at one configuration;
//! - swept ([`SweptHits`]): whether and when they first do on the straight lines from one configuration to another;
//! - ball ([`BallHits`]): whether their boxes, around all positions in a ball of configurations, overlap.

mod ball;
mod discrete;
mod hits;
mod separating_axis;
mod swept;
mod test;

pub(crate) use ball::BallHits;
pub(crate) use discrete::DiscreteHits;
pub(crate) use separating_axis::are_separated;
pub use swept::Impact;
pub(crate) use swept::SweptHits;
pub(crate) use test::NarrowPhase;
