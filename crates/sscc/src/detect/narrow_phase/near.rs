//! The near narrow phase: keeps every pair of triangles that the tests in single precision, of widened boxes and of separating
//! axes, do not rule out.

use glam::DVec3;

use super::hits::Hits;
use super::narrow_phase::NarrowPhase;
use crate::Pair;
use crate::filter::{PairFilter, Relation};

/// The pairs of a search for near triangles.
#[derive(Clone, Default)]
pub(crate) struct NearHits(pub(crate) Hits<Pair>);

impl NarrowPhase<2> for NearHits {
    type Hit = Pair;

    #[inline]
    fn test(
        &self,
        _: &PairFilter,
        _: Relation,
        pair: Pair,
        _: &[[DVec3; 3]; 2],
        _: &[[DVec3; 3]; 2],
    ) -> Option<Pair> {
        Some(pair)
    }

    #[inline]
    fn hits(&mut self) -> &mut Hits<Pair> {
        &mut self.0
    }
}
