//! Lower bounds of all triangle pairs between two leaves, or within one, without subdivision (paper, section 5.1).
//!
//! First, all pairs are bounded along the best direction of the two nodes. Then the pair with the smallest bound is
//! refined, until the smallest bound belongs to a refined pair. Its direction, and one affine map of all vertices, are
//! tried for all pairs and often suffice.

use glam::DVec3;

use super::radius_search_context::RadiusSearchContext;
use crate::Pair;
use crate::bounds::{LeafPair, PairRefiner, RefinementTarget};
use crate::filter::Hulls;
use crate::hierarchy::NodePair;

/// Directions along which all pairs are bounded, beside the first one.
const MAX_SHARED_DIRECTIONS: usize = 3;

/// Two hulls of a triangle pair and a lower bound. Where two triangles collide, at least one of their hull pairs does.
struct HullPair {
    triangles: Pair,
    x: [u32; 3],
    y: [u32; 3],
    lower: f64,
    /// Only subdivision would make the bound better.
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
    hulls: Vec<HullPair>,
}

impl<'a> LeafBounds<'a> {
    pub(super) fn new(context: RadiusSearchContext<'a>) -> Self {
        Self { context, leaves: LeafPair::new(context.model), hulls: Vec::new() }
    }

    /// Takes the pairs between leaves n and m, or within n = m, that may have a radius below `certified`. `dir`: a
    /// direction in which all are bounded.
    pub(super) fn load(&mut self, (n, m): NodePair, dir: Option<DVec3>, certified: f64) {
        let RadiusSearchContext { hierarchy, filter, .. } = self.context;
        let [x, y] = [n, m].map(|n| hierarchy.triangles(&hierarchy.nodes()[n as usize]));
        self.leaves.load(x, y);
        if let Some(dir) = dir {
            self.leaves.set_direction(dir);
        }
        self.hulls.clear();
        for (i, &a) in x.iter().enumerate() {
            for &b in if n == m { &y[i + 1..] } else { y } {
                for Hulls { a: x, b: y } in filter.hulls(a, b) {
                    let lower = dir.map_or(0.0, |_| self.leaves.bound_along_direction(x, y));
                    if lower < certified && !filter.is_excluded(a, b) {
                        self.hulls.push(HullPair { triangles: (a, b), x, y, lower, is_refined: false });
                    }
                }
            }
        }
    }

    /// Refines the pair with the smallest bound until the smallest bound belongs to a refined pair. Lowers
    /// `target.upper`, and returns the triangle pair that lowered it last, if any.
    pub(super) fn refine(
        &mut self,
        refiner: &mut PairRefiner<'_>,
        target: &mut RefinementTarget,
        certified: f64,
    ) -> Option<Pair> {
        let Self { leaves, hulls, .. } = self;
        let mut closest = None;
        let mut smallest_refined = certified;
        for round in 0.. {
            let goal = target.sufficient().min(smallest_refined);
            let open = hulls.iter_mut().filter(|hull| !hull.is_refined && hull.lower < goal);
            let Some(worst) = open.reduce(|a, b| if b.lower < a.lower { b } else { a }) else { break };
            worst.is_refined = true;
            let upper = target.upper;
            worst.lower = worst.lower.max(refiner.bound(worst.x, worst.y, target));
            if target.upper < upper {
                closest = Some(worst.triangles);
            }
            smallest_refined = smallest_refined.min(worst.lower);
            let goal = target.sufficient().min(smallest_refined);
            let is_open = |hull: &HullPair| !hull.is_refined && hull.lower < goal;
            if round < MAX_SHARED_DIRECTIONS
                && hulls.iter().any(is_open)
                && let Some(dir) = refiner.best_direction()
            {
                leaves.set_direction(dir);
                hulls.iter_mut().for_each(|hull| {
                    hull.lower = hull.lower.max(leaves.bound_along_direction(hull.x, hull.y))
                });
            }
            if round == 0 {
                for hull in hulls.iter_mut().filter(|hull| is_open(hull)) {
                    hull.lower = hull.lower.max(leaves.bound_by_affine_map(hull.x, hull.y, goal));
                }
            }
        }
        closest
    }

    /// The triangle pairs with their bounds: the smallest of their hulls'.
    pub(super) fn triangle_pairs(&self) -> impl Iterator<Item = BoundedTriangles> {
        self.hulls.chunk_by(|a, b| a.triangles == b.triangles).map(|hulls| BoundedTriangles {
            triangles: hulls[0].triangles,
            lower: hulls.iter().map(|hull| hull.lower).fold(f64::INFINITY, f64::min),
        })
    }
}
