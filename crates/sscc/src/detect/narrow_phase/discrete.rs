//! The discrete narrow phase: triangles that have a point in common at one configuration.

use glam::DVec3;

use super::hits::Hits;
use super::narrow_phase::NarrowPhase;
use crate::Pair;
use crate::filter::{PairFilter, Relation};

/// The colliding pairs of a discrete search.
#[derive(Clone, Default)]
pub(crate) struct DiscreteHits(pub(crate) Hits<Pair>);

impl NarrowPhase<1> for DiscreteHits {
    type Hit = Pair;

    #[inline]
    fn test(
        &self,
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        [a]: &[[DVec3; 3]; 1],
        [b]: &[[DVec3; 3]; 1],
    ) -> Option<Pair> {
        filter.collide_as(relation, pair, a, b).then_some(pair)
    }

    #[inline]
    fn hits(&mut self) -> &mut Hits<Pair> {
        &mut self.0
    }
}
