//! The swept narrow phase (CCD): triangles that have a point in common on the straight lines between two configurations.

use glam::DVec3;

use super::hits::Hits;
use super::impact::Impact;
use super::narrow_phase::NarrowPhase;
use crate::filter::{PairFilter, Relation};
use crate::{MovingTriangle, Pair, impact_triangle_triangle};

/// The impacts of a swept search.
#[derive(Clone, Default)]
pub(crate) struct SweptHits(pub(crate) Hits<Impact>);

impl NarrowPhase<2> for SweptHits {
    type Hit = Impact;

    #[inline]
    fn test(
        &self,
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        [a_t0, a_t1]: &[[DVec3; 3]; 2],
        [b_t0, b_t1]: &[[DVec3; 3]; 2],
    ) -> Option<Impact> {
        let a = MovingTriangle { t0: *a_t0, t1: *a_t1 };
        let b = MovingTriangle { t0: *b_t0, t1: *b_t1 };
        let time = |a: &MovingTriangle, b: &MovingTriangle| {
            // Boxes in single precision overlap more often than exact ones, and the answer must not depend on them.
            if a.is_swept_aabb_overlapping(b) {
                impact_triangle_triangle(a, b, Impact::TOLERANCE)
            } else {
                None
            }
        };
        let time = match relation {
            Relation::Adjacent => None,
            Relation::NonAdjacent => time(&a, &b),
            Relation::SharedVertex(class) => filter
                .moving_simplex_pairs(class, pair, [a_t0, a_t1], [b_t0, b_t1])
                .filter_map(|simplices| time(&a.simplex(simplices.a), &b.simplex(simplices.b)))
                .reduce(f64::min),
            // Continuous queries refuse filters with foldable pairs.
            Relation::Foldable => time(&a, &b),
        };
        time.map(|time| Impact { pair, time })
    }

    #[inline]
    fn hits(&mut self) -> &mut Hits<Impact> {
        &mut self.0
    }
}
