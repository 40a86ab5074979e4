//! How far the shape can go towards q: the largest certified scale, found through the tree.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec3;

use super::Query;
use crate::bounds::{Line, MovingAabb};
use crate::certificates::PairEntry;
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::{Certificates, Error, Pair, PairTree};

impl Query<'_> {
    /// A scale s such that the shape is proven free on the whole way `center + t (q - center)`, t in [0, s]: for
    /// certificates about q = 0, at every `t q`. It is at least what the root's radius gives, and about as
    /// large as the way is free: where that fails, nodes and pairs of nodes are bounded by their own radii, and what
    /// these leave open by the way itself. Beyond `R_global` ([`Certificates::global_radius`]) nothing is looked at: s
    /// ends there. 0 where the shape collides at the centre (pairs that are ignored apart); infinite where nothing
    /// moves.
    ///
    /// Takes as long as 5 to 30 traditional queries (much longer without certificates), and allocates.
    ///
    /// # Errors
    /// As [`Query::discrete`].
    pub fn safe_scale(&mut self, q: &[f64]) -> Result<f64, Error> {
        self.begin([q], usize::MAX)?;
        let path = Line::new(self.asked.model, &self.asked.scope.center, q);
        let global = self.asked.certificates.map_or(f64::INFINITY, Certificates::global_radius);
        let mut best = (global / self.norm).min(path.farthest) * DOWN;
        if self.norm == 0.0 {
            best = f64::INFINITY;
        }
        let boxes = PathBoxes::new(&path, &self.asked.hierarchy, self.asked.model.mesh().faces());
        for &(x, y) in self.asked.certificates.map_or(&[][..], Certificates::exceptions) {
            if self.asked.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            best = best.min(self.follow(&path, (x, y), 0.0, best));
        }
        let tree = self.asked.certificates.map(|c| &c.parts().pair_tree).filter(|tree| tree.limit() > 0.0);
        let mut waiting = BinaryHeap::new();
        waiting.push(Entry { lower: self.certified_scale(0), n: 0, m: 0, place: NONE });
        // Always what could meet first: everything is followed only a little farther than all others are free.
        while let Some(Entry { lower, n, m, place }) = waiting.pop() {
            if lower >= best {
                break;
            }
            if self.asked.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            self.discrete.statistics.opened += 1;
            let mut consider = |(n, m): Pair, place: u32, bound: f64, best: f64| {
                let lower = lower.max(bound);
                if lower < best {
                    waiting.push(Entry { lower, n, m, place });
                }
            };
            let [node_n, node_m] = [n, m].map(|n| self.asked.hierarchy.nodes()[n as usize]);
            let hierarchy = &self.asked.hierarchy;
            if let Some(split) = hierarchy.split(n, m).filter(|_| n != m) {
                let ends =
                    place == UNKNOWN || (place != NONE && hierarchy.split_above_buckets(n, m).is_none());
                let certified = if ends {
                    [(UNKNOWN, 0.0); MOST_SIBLINGS]
                } else {
                    let stored = tree.filter(|_| place != NONE).map(|tree| tree.below(place));
                    self.certified_pairs(tree, stored.into_iter().flatten())
                };
                for (pair, (place, bound)) in split.pairs().zip(certified) {
                    consider(pair, place, bound.max(boxes.apart(&path, pair)), best);
                }
            } else if node_n.is_leaf() {
                let goal = (lower * AHEAD).max(best * LEAST).min(best);
                let triangles = |node| self.asked.hierarchy.triangles(node);
                for (i, &x) in triangles(&node_n).iter().enumerate() {
                    // Most triangles of a leaf stay clear of the whole other leaf.
                    let box_x = &boxes.triangles[x as usize];
                    if n != m && path.aabbs_separated_until(box_x, &boxes.nodes[m as usize]) >= goal {
                        continue;
                    }
                    let first = if n == m { i + 1 } else { 0 };
                    for &y in &triangles(&node_m)[first..] {
                        self.discrete.statistics.box_tests += 1;
                        if path.aabbs_separated_until(box_x, &boxes.triangles[y as usize]) < goal {
                            self.discrete.statistics.triangle_tests += 1;
                            best = best.min(self.follow(&path, (x, y), lower, goal.min(best)));
                        }
                    }
                }
                consider((n, m), place, goal, best);
            } else {
                for child in node_n.children() {
                    consider((child, child), NONE, self.certified_scale(child), best);
                }
                let certified = if self.asked.hierarchy.is_bucket_below_root(n) {
                    [(UNKNOWN, 0.0); MOST_SIBLINGS]
                } else {
                    let stored = tree.map(|tree| tree.of_node(n));
                    self.certified_pairs(tree, stored.into_iter().flatten())
                };
                for (which, (pair, (place, bound))) in node_n.child_pairs().zip(certified).enumerate() {
                    let radii =
                        self.asked.certificates.filter(|_| n == 0).map(|c| &c.parts().root_pair_radii);
                    let bound = radii.map_or(bound, |radii| bound.max(self.scale(radii[which])));
                    consider(pair, place, bound.max(boxes.apart(&path, pair)), best);
                }
            }
        }
        self.discrete.statistics.complete = true;
        Ok(best)
    }

    /// The scale up to which a node's own radius certifies it.
    fn certified_scale(&self, node: u32) -> f64 {
        self.asked.certificates.map_or(0.0, |certificates| self.scale(certificates.node_radius(node)))
    }

    /// For each of some siblings its place in the pair tree and the scale up to which it is certified, where these are
    /// stored: for the others the scale of the tree's limit.
    fn certified_pairs(
        &self,
        tree: Option<&PairTree>,
        stored: impl Iterator<Item = (u32, PairEntry)>,
    ) -> [(u32, f64); MOST_SIBLINGS] {
        let mut all = [(NONE, self.scale(tree.map_or(0.0, PairTree::limit))); MOST_SIBLINGS];
        for (place, entry) in stored {
            all[entry.which() as usize] = (place, self.scale(f64::from(entry.radius)));
        }
        all
    }

    /// The scale at which a radius is reached; [`Query::norm`] is that of scale 1.
    fn scale(&self, radius: f64) -> f64 {
        let scale = radius / self.norm;
        if radius > 0.0 && scale >= f64::MIN_POSITIVE { scale * DOWN } else { 0.0 }
    }

    /// Follows two triangles that do not collide before `t`: infinite when they do not before `goal`, or do not count;
    /// else a scale below which they do not, about where they meet.
    fn follow(&self, path: &Line, (x, y): Pair, t: f64, goal: f64) -> f64 {
        if self.asked.filter.is_excluded(x, y) {
            return f64::INFINITY;
        }
        let hulls = self.asked.filter.hulls(x, y);
        hulls.map(|hulls| path.advance(hulls.a, hulls.b, t, goal)).fold(f64::INFINITY, f64::min)
    }
}

/// Covers what scales and norms at scales are rounded.
const DOWN: f64 = 1.0 - 64.0 * f64::EPSILON;

/// Pairs of leaves are followed up to this many times the scale up to which all others are free ...
const AHEAD: f64 = 1.5;

/// ... but at least up to this share of the best known end.
const LEAST: f64 = 1.0 / 64.0;

/// The place of what is not in the pair tree: a node against itself, and pairs certified up to its limit.
const NONE: u32 = u32::MAX;

/// The place of what the pair tree says nothing of: within a small node, and below the tree's ends.
const UNKNOWN: u32 = u32::MAX - 1;

/// The pairs of the four children that a node has at most.
const MOST_SIBLINGS: usize = 6;

/// A node against itself (n = m), or two nodes, and a scale below which they do not collide.
struct Entry {
    lower: f64,
    n: u32,
    m: u32,
    place: u32,
}

/// Smallest scale first; then by number, so that the order is always the same.
impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower.total_cmp(&self.lower).then_with(|| (other.n, other.m).cmp(&(self.n, self.m)))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// For each node and each triangle the box of its vertices at the centre and that of their velocities.
struct PathBoxes {
    nodes: Vec<MovingAabb>,
    triangles: Vec<MovingAabb>,
}

impl PathBoxes {
    fn new(path: &Line, hierarchy: &Hierarchy, faces: &[[u32; 3]]) -> Self {
        let of_face = |face: &[u32; 3]| {
            let of = |all: &[DVec3]| Aabb::of_triangle(face.map(|v| all[v as usize]));
            MovingAabb { positions: of(&path.positions), velocities: of(&path.velocities) }
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

    /// A scale below which some axis separates the two nodes all the way.
    fn apart(&self, path: &Line, (n, m): Pair) -> f64 {
        path.aabbs_separated_until(&self.nodes[n as usize], &self.nodes[m as usize])
    }
}
