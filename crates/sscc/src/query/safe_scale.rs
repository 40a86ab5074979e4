//! The safe scale: how far along the line from the centre to q the shape is proven free. It is found by a best-first search
//! over the hierarchy, with conservative advancement of triangle pairs.

use std::collections::BinaryHeap;

use glam::DVec3;

use super::local_scales::LocalScales;
use super::query::Query;
use crate::arithmetic::check_arithmetic;
use crate::bounds::{ConfigurationLine, MovingAabb};
use crate::certificates::PairTree;
use crate::certificates::StoredPair;
use crate::geometry::Aabb;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::min_heap::MinHeapEntry;
use crate::{Certificates, Error, Pair};

impl Query {
    /// Returns a scale s such that the shape is proven free at `center + t (q - center)` for all t in [0, s]: for
    /// certificates about q = 0, at every `t q`. If no pair collides at the centre, it is at least the scale at which
    /// the root's radius is reached, rounded down. It is close to the largest possible one, and at most the scale at
    /// which radii are capped ([`Certificates::global_radius`]). Nodes and node pairs are bounded by their certified
    /// radii and local certificates, and triangle pairs beyond these by conservative advancement along the line. The
    /// scale is 0 if the shape collides at the centre (ignored pairs apart), if triangles are closer there than rounding errors, or,
    /// unless q is the centre, if a coordinate there is beyond half of [`limits::LARGEST`](crate::limits::LARGEST). Else, if q is
    /// the centre, it is infinite with certificates of collisions, but may be finite without.
    ///
    /// Takes as long as 5 to 30 traditional queries (much longer without certificates), and allocates.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn safe_scale(&mut self, q: &[f64]) -> Result<f64, Error> {
        self.forget();
        check_arithmetic()?;
        self.norm = self.measure(q)?.norm;
        let line = ConfigurationLine::new(&self.context.model, &self.context.scope.center, q);
        let global = self.context.certificates.as_ref().map_or(f64::INFINITY, Certificates::global_radius);
        let mut best = (global / self.norm).min(line.farthest) * with_mutant!(DOWN, SafeScaleToNearest, 1.0);
        if self.norm == 0.0 {
            best = f64::INFINITY;
        }
        let aabbs = LineAabbs::new(&line, &self.context.detect.hierarchy, self.context.model.mesh().faces());
        for &(x, y) in self.context.certificates.as_ref().map_or(&[][..], Certificates::exceptions) {
            if self.context.detect.is_cancelled() {
                return Err(Error::Cancelled);
            }
            let found = self.advance(&line, (x, y), 0.0, best);
            best = with_mutant!(best.min(found), SafeScaleWithoutExceptions, best);
        }
        let tree = self
            .context
            .certificates
            .as_ref()
            .map(|c| &c.parts().pair_tree)
            .filter(|tree| tree.limit() > 0.0);
        let mut locals = LocalScales::new(&self.context, &mut self.check, q, self.norm, best);
        let mut waiting = BinaryHeap::new();
        let local = locals.as_mut().map_or(0.0, |locals| locals.of_pair((0, 0)));
        let local = local * with_mutant!(DOWN, SafeScaleToNearest, 1.0);
        waiting.push(MinHeapEntry { key: self.certified_scale(0).max(local), order: (0, 0), item: NONE });
        // In best-first order a pair is advanced only a little farther than the scale up to which all others are free.
        while let Some(MinHeapEntry { key: lower, order: (n, m), item: index }) = waiting.pop() {
            // Shares of a smaller scale may round to 0, so that a leaf would return with the same key for ever.
            if with_mutant!(best < f64::MIN_POSITIVE, SmallestScalesSearched, false) {
                best = 0.0;
            }
            if lower >= best {
                break;
            }
            if self.context.detect.is_cancelled() {
                return Err(Error::Cancelled);
            }
            self.statistics.opened += 1;
            let mut consider = |(n, m): NodePair, index: u32, bound: f64, best: f64| {
                let lower = lower.max(bound);
                let lower = locals.as_mut().filter(|_| lower < best).map_or(lower, |locals| {
                    lower.max(locals.of_pair((n, m)) * with_mutant!(DOWN, SafeScaleToNearest, 1.0))
                });
                if lower < best {
                    waiting.push(MinHeapEntry { key: lower, order: (n, m), item: index });
                }
            };
            let [node_n, node_m] = [n, m].map(|n| self.context.detect.hierarchy.nodes()[n as usize]);
            let hierarchy = &self.context.detect.hierarchy;
            if let Some(split) = hierarchy.split(n, m).filter(|_| n != m) {
                let ends =
                    index == UNKNOWN || (index != NONE && hierarchy.split_above_buckets(n, m).is_none());
                let certified = if ends {
                    let bound = with_mutant!(
                        0.0,
                        SafeScaleBelowBuckets,
                        self.scale(tree.map_or(0.0, PairTree::limit))
                    );
                    [(UNKNOWN, bound); MAX_SIBLINGS]
                } else {
                    let stored = tree.filter(|_| index != NONE).map(|tree| tree.below(index));
                    self.certified_pairs(tree, stored.into_iter().flatten())
                };
                for (pair, (index, bound)) in split.pairs().zip(certified) {
                    consider(pair, index, bound.max(aabbs.separated_until(&line, pair)), best);
                }
            } else if node_n.is_leaf() {
                let goal = (lower * LOOK_AHEAD).max(best * MIN_GOAL).min(best);
                let triangles = |node| self.context.detect.hierarchy.triangles(node);
                for (i, &x) in triangles(&node_n).iter().enumerate() {
                    // Most triangles of a leaf are separate from the whole other leaf.
                    let aabb_x = &aabbs.triangles[x as usize];
                    if n != m && line.aabbs_separated_until(aabb_x, &aabbs.nodes[m as usize]) >= goal {
                        continue;
                    }
                    let first = if n == m { i + 1 } else { 0 };
                    for &y in &triangles(&node_m)[first..] {
                        self.statistics.box_tests += 1;
                        if line.aabbs_separated_until(aabb_x, &aabbs.triangles[y as usize]) < goal {
                            self.statistics.triangle_tests += 1;
                            best = best.min(self.advance(&line, (x, y), lower, goal.min(best)));
                        }
                    }
                }
                if with_mutant!(true, LeavesAdvancedOnce, false) {
                    consider((n, m), index, goal, best);
                }
            } else {
                for child in node_n.children() {
                    consider((child, child), NONE, self.certified_scale(child), best);
                }
                let certified = if self.context.detect.hierarchy.is_bucket_below_root(n) {
                    [(UNKNOWN, 0.0); MAX_SIBLINGS]
                } else {
                    let stored = tree.map(|tree| tree.of_node(n));
                    self.certified_pairs(tree, stored.into_iter().flatten())
                };
                for (which, (pair, (index, bound))) in node_n.child_pairs().zip(certified).enumerate() {
                    let radii = self
                        .context
                        .certificates
                        .as_ref()
                        .filter(|_| n == 0)
                        .map(|c| &c.parts().root_pair_radii);
                    let bound = radii.map_or(bound, |radii| bound.max(self.scale(radii[which])));
                    consider(pair, index, bound.max(aabbs.separated_until(&line, pair)), best);
                }
            }
        }
        self.statistics.complete = true;
        Ok(best)
    }

    /// Returns the scale up to which a node's own radius certifies it.
    fn certified_scale(&self, node: u32) -> f64 {
        self.context
            .certificates
            .as_ref()
            .map_or(0.0, |certificates| self.scale(certificates.node_radius(node)))
    }

    /// Returns for each of some sibling node pairs its entry in the pair tree and the scale up to which it is certified; for
    /// pairs that are not stored the scale of the tree's limit.
    fn certified_pairs(
        &self,
        tree: Option<&PairTree>,
        stored: impl Iterator<Item = StoredPair>,
    ) -> [(u32, f64); MAX_SIBLINGS] {
        let mut all = [(NONE, self.scale(tree.map_or(0.0, PairTree::limit))); MAX_SIBLINGS];
        for StoredPair { index, entry } in stored {
            all[entry.which() as usize] = (index, self.scale(f64::from(entry.radius)));
        }
        all
    }

    /// Returns the scale at which a radius is reached; `Query::norm` is the norm at scale 1.
    fn scale(&self, radius: f64) -> f64 {
        let scale = radius / self.norm;
        if radius > 0.0 && scale >= f64::MIN_POSITIVE {
            scale * with_mutant!(DOWN, SafeScaleToNearest, 1.0)
        } else {
            0.0
        }
    }

    /// Advances two triangles that do not collide before `t`. Returns infinity if they do not collide before `goal` or do
    /// not count; otherwise a scale below which they do not collide, close to the contact.
    fn advance(&self, line: &ConfigurationLine, (x, y): Pair, t: f64, goal: f64) -> f64 {
        if self.context.detect.filter.is_excluded(x, y) {
            return f64::INFINITY;
        }
        let simplices = self.context.detect.filter.simplex_pairs(x, y);
        simplices
            .map(|simplices| line.advance(simplices.a, simplices.b, t, goal))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Covers the rounding of scales and of norms at scales.
///
/// (Norms cover it, too. `|z|` is rounded up by at least `(1.5 r + 27)` units of 2^-53 more than its own rounding; the
/// quotient, and `t (q - center)` in f64, are rounded by 3 of them. The sum with the centre moves vertices by no more
/// than the rounding of their positions, which is part of every radius.)
const DOWN: f64 = 1.0 - 64.0 * f64::EPSILON;

/// Leaf pairs are advanced up to this many times the scale up to which all others are free.
const LOOK_AHEAD: f64 = 1.5;

/// Leaf pairs are advanced at least up to this share of the best known scale.
const MIN_GOAL: f64 = 1.0 / 64.0;

/// The index of a node, or of a node pair that is certified up to the limit of the pair tree: they have no entry.
const NONE: u32 = u32::MAX;

/// The index of a node pair outside the pair tree: within a bucket, or below a pair of buckets.
const UNKNOWN: u32 = u32::MAX - 1;

/// The largest number of pairs of children of a node, which has at most four children.
const MAX_SIBLINGS: usize = 6;

/// For each node and each triangle the AABBs of its vertices at the centre and of their velocities.
struct LineAabbs {
    nodes: Vec<MovingAabb>,
    triangles: Vec<MovingAabb>,
}

impl LineAabbs {
    fn new(line: &ConfigurationLine, hierarchy: &Hierarchy, faces: &[[u32; 3]]) -> Self {
        let of_face = |face: &[u32; 3]| {
            let of = |all: &[DVec3]| Aabb::of_triangle(face.map(|v| all[v as usize]));
            MovingAabb { positions: of(&line.positions), velocities: of(&line.velocities) }
        };
        let triangles: Vec<MovingAabb> = faces.iter().map(of_face).collect();
        let mut nodes = vec![MovingAabb::EMPTY; hierarchy.nodes().len()];
        let union = |all: MovingAabb, next: &MovingAabb| all.union(next);
        for n in (0..nodes.len()).rev() {
            let node = &hierarchy.nodes()[n];
            nodes[n] = if node.is_leaf() {
                let of = |t: &u32| &triangles[*t as usize];
                hierarchy.triangles(node).iter().map(of).fold(MovingAabb::EMPTY, union)
            } else {
                let children = node.children().start as usize..node.children().end as usize;
                nodes[children].iter().fold(MovingAabb::EMPTY, union)
            };
        }
        Self { nodes, triangles }
    }

    /// Returns a scale below which one axis separates the two nodes.
    fn separated_until(&self, line: &ConfigurationLine, (n, m): NodePair) -> f64 {
        line.aabbs_separated_until(&self.nodes[n as usize], &self.nodes[m as usize])
    }
}

#[cfg(test)]
mod tests {
    use crate::certificates::CertificateParts;
    use crate::test_models::{Random, square};
    use crate::{Certificates, CertifyOptions, Method, Modes, Query, ReducedModel};

    /// Nothing reaches the radii of the root's pairs; pairs within its children still end the scale.
    #[test]
    fn contacts_within_the_children_of_the_root_end_the_scale() {
        let mut tight = 0;
        for case in 0..6 {
            let random = &mut Random(case + 40);
            let mesh = square(12);
            let modes = (0..mesh.rest_positions().len()).map(|_| random.vector()).collect();
            let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
            let options = CertifyOptions::default().local_budget(0).epsilon(0.5);
            let honest = Certificates::compute(&model, &options, &()).unwrap();
            let parts = honest.parts();
            let root_pair_radii = vec![f64::INFINITY; parts.root_pair_radii.len()];
            let edited =
                Certificates::try_from(CertificateParts { root_pair_radii, ..parts.clone() }).unwrap();
            let (hierarchy, nodes) = (&parts.hierarchy, parts.hierarchy.nodes());
            let child_of = |t: u32| {
                nodes[0].children().position(|n| hierarchy.triangles(&nodes[n as usize]).contains(&t))
            };
            let mut oracle = Query::with_method(&model, &honest, Method::BruteForce).unwrap();
            let mut within = |t: f64| {
                let pairs = oracle.discrete(&[t]).unwrap();
                pairs.iter().filter(|(a, b)| child_of(*a) == child_of(*b)).count()
            };
            let scale = Query::new(&model, &edited).unwrap().safe_scale(&[1.0]).unwrap();
            for share in [1.0, 0.99, 0.9, 0.7, 0.5] {
                assert_eq!(within(share * scale), 0, "case {case}: {share} of {scale}");
            }
            tight += usize::from(within(1.05 * scale) > 0);
        }
        assert!(tight > 0);
    }
}
