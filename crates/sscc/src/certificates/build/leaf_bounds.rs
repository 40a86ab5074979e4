//! Lower bounds of all triangle pairs between two leaves, or within one, without subdivision (paper, section 5.1).
//!
//! First, all pairs are bounded along the best direction of the two nodes. Then the pair with the smallest bound is
//! refined, until the smallest bound belongs to a refined pair. Its direction, and one affine map of all vertices, are
//! tried for all pairs and often suffice.

use glam::DVec3;

use super::radius_search_context::RadiusSearchContext;
use crate::Pair;
use crate::bounds::{LeafPair, PairRefiner, RefinementTarget};
use crate::filter::SimplexPair;
use crate::hierarchy::NodePair;

/// Maximum number of directions along which all pairs are bounded, beside the first one.
const MAX_SHARED_DIRECTIONS: usize = 3;

/// A simplex pair of a triangle pair, and a lower bound. If two triangles collide, at least one of their simplex pairs does.
struct BoundedSimplexPair {
    triangles: Pair,
    x: [u32; 3],
    y: [u32; 3],
    lower: f64,
    /// Whether only subdivision would make the bound larger.
    is_refined: bool,
}

/// A triangle pair and a lower bound of its radius.
#[derive(Clone, Copy)]
pub(super) struct BoundedTriangles {
    pub(super) triangles: Pair,
    pub(super) lower: f64,
}

/// The triangle pairs between two leaves; owns its memory.
pub(super) struct LeafBounds<'a> {
    context: RadiusSearchContext<'a>,
    leaves: LeafPair<'a>,
    pairs: Vec<BoundedSimplexPair>,
}

impl<'a> LeafBounds<'a> {
    pub(super) fn new(context: RadiusSearchContext<'a>) -> Self {
        Self { context, leaves: LeafPair::new(context.model), pairs: Vec::new() }
    }

    /// Loads the pairs between leaves n and m, or within n = m, that may have a radius below `certified`. All are bounded along
    /// `dir`, if it is given.
    pub(super) fn load(&mut self, (n, m): NodePair, dir: Option<DVec3>, certified: f64) {
        let RadiusSearchContext { hierarchy, filter, rings, .. } = self.context;
        let [x, y] = [n, m].map(|n| hierarchy.triangles(&hierarchy.nodes()[n as usize]));
        self.leaves.load(x, y);
        if let Some(dir) = dir {
            self.leaves.set_direction(dir);
        }
        self.pairs.clear();
        for (i, &a) in x.iter().enumerate() {
            for &b in if n == m { &y[i + 1..] } else { y } {
                for SimplexPair { a: x, b: y } in filter.simplex_pairs(a, b) {
                    let lower = dir.map_or(0.0, |_| self.leaves.bound_along_direction(x, y));
                    if lower < certified && !filter.is_excluded(a, b) && !rings.contain(a, b) {
                        self.pairs.push(BoundedSimplexPair {
                            triangles: (a, b),
                            x,
                            y,
                            lower,
                            is_refined: false,
                        });
                    }
                }
            }
        }
    }

    /// Refines the pair with the smallest bound until the smallest bound belongs to a refined pair or is sufficient.
    /// Lowers `target.upper`, and returns the triangle pair that lowered it last, if any.
    pub(super) fn refine(
        &mut self,
        refiner: &mut PairRefiner<'_>,
        target: &mut RefinementTarget,
        certified: f64,
    ) -> Option<Pair> {
        let Self { leaves, pairs, .. } = self;
        let mut closest = None;
        let mut smallest_refined = certified;
        for round in 0.. {
            let goal = target.sufficient().min(smallest_refined);
            let open = pairs.iter_mut().filter(|pair| !pair.is_refined && pair.lower < goal);
            let Some(worst) = open.reduce(|a, b| if b.lower < a.lower { b } else { a }) else { break };
            worst.is_refined = true;
            let upper = target.upper;
            worst.lower = worst.lower.max(refiner.bound(worst.x, worst.y, target));
            if target.upper < upper {
                closest = Some(worst.triangles);
            }
            smallest_refined = smallest_refined.min(worst.lower);
            let goal = target.sufficient().min(smallest_refined);
            let is_open = |pair: &BoundedSimplexPair| !pair.is_refined && pair.lower < goal;
            if round < MAX_SHARED_DIRECTIONS
                && pairs.iter().any(is_open)
                && let Some(dir) = refiner.best_direction()
            {
                leaves.set_direction(dir);
                pairs.iter_mut().for_each(|pair| {
                    pair.lower = pair.lower.max(leaves.bound_along_direction(pair.x, pair.y))
                });
            }
            if round == 0 {
                for pair in pairs.iter_mut().filter(|pair| is_open(pair)) {
                    pair.lower = pair.lower.max(leaves.bound_by_affine_map(pair.x, pair.y, goal));
                }
            }
        }
        closest
    }

    /// Returns the triangle pairs, each with the smallest bound of its simplex pairs.
    pub(super) fn triangle_pairs(&self) -> impl Iterator<Item = BoundedTriangles> {
        self.pairs.chunk_by(|a, b| a.triangles == b.triangles).map(|pairs| BoundedTriangles {
            triangles: pairs[0].triangles,
            lower: pairs[..with_mutant!(pairs.len(), LeafPairOfFirstSimplices, 1)]
                .iter()
                .map(|pair| pair.lower)
                .fold(f64::INFINITY, f64::min),
        })
    }
}
