//! The narrow phase: the test of two triangles whose boxes overlap. There are five kinds:
//!
//! - discrete ([`DiscreteHits`]): whether they have a point in common at one configuration;
//! - swept ([`SweptHits`]): whether and when they first do on the straight lines from one configuration to another;
//! - AABB ([`AabbHits`]): whether their AABBs, around all positions in a region of z or between two configurations, overlap;
//! - clearance ([`ClearanceHits`]): whether they are nearer than a distance at one configuration;
//! - near ([`NearHits`]): no test; it keeps all pairs that widened boxes and separating axes do not rule out.

mod aabb;
mod clearance;
mod discrete;
mod hits;
mod impact;
#[allow(clippy::module_inception)] // named after its trait, as all files here
mod narrow_phase;
mod near;
mod separating_axis;
mod swept;

pub(crate) use aabb::AabbHits;
pub(crate) use clearance::ClearanceHits;
pub use clearance::NearPair;
pub(crate) use discrete::DiscreteHits;
pub use impact::Impact;
pub(crate) use narrow_phase::NarrowPhase;
pub(crate) use near::NearHits;
pub(crate) use separating_axis::TrianglePairs;
pub(crate) use swept::SweptHits;
