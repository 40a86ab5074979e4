//! The clearance narrow phase: triangles nearer than a distance at one configuration.

use glam::DVec3;

use super::hits::Hits;
use super::narrow_phase::NarrowPhase;
use crate::filter::{PairFilter, Relation};
use crate::{Pair, distance_triangle_triangle};

/// Two triangles and their distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPair {
    /// The triangles; of one mesh, the lower number first.
    pub pair: Pair,
    /// Their distance (model unit), with the error of [`distance_triangle_triangle`]; it is 0 exactly if they collide.
    pub distance: f64,
}

/// The pairs of a search that are nearer than a distance, except triangles with a common vertex.
#[derive(Clone, Default)]
pub(crate) struct ClearanceHits {
    pub(crate) distance: f64,
    pub(crate) hits: Hits<NearPair>,
}

impl NarrowPhase<1> for ClearanceHits {
    type Hit = NearPair;

    #[inline]
    fn test(
        &self,
        _: &PairFilter,
        relation: Relation,
        pair: Pair,
        [a]: &[[DVec3; 3]; 1],
        [b]: &[[DVec3; 3]; 1],
    ) -> Option<NearPair> {
        if relation != Relation::NonAdjacent {
            return None;
        }
        let distance = distance_triangle_triangle(a, b);
        let is_near = with_mutant!(distance < self.distance, ClearanceReached, distance <= self.distance);
        is_near.then_some(NearPair { pair, distance })
    }

    #[inline]
    fn hits(&mut self) -> &mut Hits<NearPair> {
        &mut self.hits
    }
}
