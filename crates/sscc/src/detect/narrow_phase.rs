//! What is asked of two triangles: whether they collide at one configuration, or meet between two.

use glam::DVec3;

use crate::filter::{PairFilter, Relation};
use crate::geometry::Aabb;
use crate::query::Impact;
use crate::{MovingTriangle, Pair, impact_triangle_triangle};

/// What a query lists: [`Pair`]s of one configuration, [`Impact`]s between two.
pub(crate) trait Found<const E: usize>: Copy {
    /// The answer for two triangles, the lower number first, that are not adjacent: by the corners of each at each end.
    /// The same for every method.
    fn of(
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        x: &[[DVec3; 3]; E],
        y: &[[DVec3; 3]; E],
    ) -> Option<Self>;

    fn pair(&self) -> Pair;
}

impl Found<1> for Pair {
    #[inline]
    fn of(
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        [x]: &[[DVec3; 3]; 1],
        [y]: &[[DVec3; 3]; 1],
    ) -> Option<Self> {
        filter.collide_as(relation, pair, x, y).then_some(pair)
    }

    fn pair(&self) -> Pair {
        *self
    }
}

/// What can collide anywhere in a ball: triangles whose boxes, around the corners at both ends, overlap.
impl Found<2> for Pair {
    #[inline]
    fn of(_: &PairFilter, _: Relation, pair: Pair, x: &[[DVec3; 3]; 2], y: &[[DVec3; 3]; 2]) -> Option<Self> {
        (!Aabb::of_swept_triangle(x).is_disjoint(&Aabb::of_swept_triangle(y))).then_some(pair)
    }

    fn pair(&self) -> Pair {
        *self
    }
}

impl Found<2> for Impact {
    #[inline]
    fn of(
        filter: &PairFilter,
        relation: Relation,
        pair: Pair,
        [x_t0, x_t1]: &[[DVec3; 3]; 2],
        [y_t0, y_t1]: &[[DVec3; 3]; 2],
    ) -> Option<Self> {
        let x = MovingTriangle { t0: *x_t0, t1: *x_t1 };
        let y = MovingTriangle { t0: *y_t0, t1: *y_t1 };
        let time = |x: &MovingTriangle, y: &MovingTriangle| {
            // Boxes that are compared in single precision overlap more often: the answer must not depend on them.
            if x.is_swept_aabb_overlapping(y) {
                impact_triangle_triangle(x, y, Impact::TOLERANCE)
            } else {
                None
            }
        };
        let time = match relation {
            Relation::Adjacent => None,
            Relation::NonAdjacent => time(&x, &y),
            Relation::SharedVertex(_) => filter
                .hulls_of_corners(pair.0, pair.1)
                .filter_map(|hulls| time(&x.hull(hulls.a), &y.hull(hulls.b)))
                .reduce(f64::min),
        };
        time.map(|time| Self { pair, time })
    }

    fn pair(&self) -> Pair {
        self.pair
    }
}
