//! The trait `NarrowPhase`: tests one triangle pair and collects the hits.

use glam::DVec3;

use super::hits::Hits;
use crate::Pair;
use crate::filter::{PairFilter, Relation};

/// Tests two triangles, and collects the hits. `DiscreteHits` is exact, `SweptHits` up to the tolerance of continuous
/// queries, and `ClearanceHits` up to the error of distances; `AabbHits` compares AABBs, and `NearHits` keeps every pair. All
/// methods of queries share these tests, so that all have the same answers, up to the tolerance of continuous queries.
pub(crate) trait NarrowPhase<const E: usize> {
    /// The entry of a colliding pair in the answer.
    type Hit: Copy;

    /// Tests two triangles that are not adjacent, the lower number first, by their corners at each configuration.
    fn test(
        &self,
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        a: &[[DVec3; 3]; E],
        b: &[[DVec3; 3]; E],
    ) -> Option<Self::Hit>;

    /// Returns the hits so far.
    fn hits(&mut self) -> &mut Hits<Self::Hit>;
}
