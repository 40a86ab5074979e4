//! The narrow phase of kinetic searches and of sweeps: triangles that may collide at some z of a region, or between
//! two configurations.

use glam::DVec3;

use super::hits::Hits;
use super::narrow_phase::NarrowPhase;
use crate::Pair;
use crate::filter::{PairFilter, Relation};
use crate::geometry::Aabb;

/// The pairs whose AABBs overlap; the two configurations have the lowest and the highest coordinates of each corner, in any
/// order.
#[derive(Clone, Default)]
pub(crate) struct AabbHits(pub(crate) Hits<Pair>);

impl NarrowPhase<2> for AabbHits {
    type Hit = Pair;

    #[inline]
    fn test(
        &self,
        _: &PairFilter,
        _: Relation,
        pair: Pair,
        a: &[[DVec3; 3]; 2],
        b: &[[DVec3; 3]; 2],
    ) -> Option<Pair> {
        (!Aabb::of_swept_triangle(a).is_disjoint(&Aabb::of_swept_triangle(b))).then_some(pair)
    }

    #[inline]
    fn hits(&mut self) -> &mut Hits<Pair> {
        &mut self.0
    }
}
