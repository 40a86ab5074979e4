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
                .reduce(with_mutant!(f64::min, LaterOfTwoTimes, f64::max)),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;
    use crate::{ContactFilter, Neighbours};

    /// Of two triangles with a common vertex either edge opposite to it may be the first to meet the other triangle.
    #[test]
    fn the_time_of_impact_is_that_of_the_earlier_edge() {
        let random = &mut Random(4);
        let filter = ContactFilter::new(Neighbours::IncludeOneVertex);
        let filter = PairFilter::with_classes(&[[0, 1, 2], [0, 3, 4]], None, &filter);
        let (mut first, mut second) = (0, 0);
        for case in 0..2000 {
            let mut corners = || [DVec3::ZERO, random.vector(), random.vector()];
            let [a, b] = [(); 2].map(|()| [corners(), corners()]);
            let [x, y] = [a, b].map(|[t0, t1]| MovingTriangle { t0, t1 });
            let edge = |triangle: &MovingTriangle| triangle.simplex([1, 2, 2]);
            let times = [(edge(&x), y), (x, edge(&y))]
                .map(|(x, y)| impact_triangle_triangle(&x, &y, Impact::TOLERANCE));
            let expected = times.into_iter().flatten().reduce(f64::min);
            let found = SweptHits::default().test(&filter, filter.relation(0, 1), (0, 1), &a, &b);
            assert_eq!(found.map(|impact| impact.time), expected, "case {case}");
            if let [Some(s), Some(t)] = times {
                first += usize::from(s < t);
                second += usize::from(t < s);
            }
        }
        assert!(first > 100 && second > 100, "{first} {second}");
    }
}
