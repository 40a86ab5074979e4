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

use glam::DVec3;

use crate::Pair;
use crate::filter::{PairFilter, Relation};

pub(crate) use ball::BallHits;
pub(crate) use discrete::DiscreteHits;
pub(crate) use hits::Hits;
pub(crate) use separating_axis::are_separated;
pub use swept::Impact;
pub(crate) use swept::SweptHits;

/// Tests two triangles exactly, and collects those that count. All methods share it, so that all give the same answers.
pub(crate) trait NarrowPhase<const E: usize> {
    /// The entry of a colliding pair in the answer.
    type Hit: Copy;

    /// Tests two triangles, the lower number first, that are not adjacent: by their corners at each end.
    fn test(
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        a: &[[DVec3; 3]; E],
        b: &[[DVec3; 3]; E],
    ) -> Option<Self::Hit>;

    /// The hits so far.
    fn hits(&mut self) -> &mut Hits<Self::Hit>;
}
