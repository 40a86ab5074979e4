//! Algorithm 1 by the certified pair tree: only pairs whose radius has been passed are looked at, down to the triangles.

use super::aabb::{disjoint, triangle_box};
use super::{Method, Query};
use crate::certificates::child_pairs;
use crate::hierarchy::Node;
use crate::pairs::Relation;
use crate::{Error, Pair, PairTree};

/// Between two looks at whether the query was cancelled.
const STEPS: u32 = 1024;

/// The place of a node against itself.
const NODE: u32 = u32::MAX;

impl<'a> Query<'a> {
    /// The pair tree, if this method uses it and it is complete for the current norm: then a pair that it does not hold
    /// is certified.
    pub(super) fn complete_pair_tree(&self) -> Option<&'a PairTree> {
        let certificates = self.certificates.filter(|_| self.method == Method::Certified)?;
        let tree = &certificates.parts().pair_tree;
        (self.norm < tree.limit()).then_some(tree)
    }

    /// Appends all colliding pairs at q, exceptions apart. On the stack, `(n, n, NODE)` stands for a node against itself,
    /// `(n, m, place)` for two nodes without common triangles.
    pub(super) fn walk_pairs(&mut self, tree: &PairTree, q: &[f64]) -> Result<(), Error> {
        self.walk.clear();
        self.walk.push((0, 0, NODE));
        let mut steps = 0_u32;
        while let Some((n, m, place)) = self.walk.pop() {
            if self.is_full() {
                break;
            }
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) && self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            if place == NODE {
                self.walk_within(tree, n, q)
            } else {
                self.walk_between(tree, (n, m, place), q)
            }
        }
        Ok(())
    }

    fn walk_within(&mut self, tree: &PairTree, n: u32, q: &[f64]) {
        if self.certificates.is_some_and(|c| self.norm < c.parts().node_radii[n as usize]) {
            return;
        }
        self.statistics.opened += 1;
        let node = self.hierarchy.nodes()[n as usize];
        if node.is_leaf() {
            let places = places(&node);
            for i in places.clone() {
                for j in i + 1..places.end {
                    self.test_places((i, j), q);
                }
            }
            return;
        }
        self.walk.extend(node.children().map(|child| (child, child, NODE)));
        let mut pairs = child_pairs(&node).enumerate();
        for (place, entry) in tree.of_node(n) {
            if let Some((_, (a, b))) = pairs.find(|(which, _)| *which == entry.which() as usize)
                && f64::from(entry.radius) <= self.norm
            {
                self.walk.push((a, b, place));
            }
        }
    }

    fn walk_between(&mut self, tree: &PairTree, (n, m, place): (u32, u32, u32), q: &[f64]) {
        // BD boxes; the vertices of small nodes are not moved for a test of boxes.
        if self.boxes.clusters.of_node(n).is_none() && self.boxes.clusters.of_node(m).is_none() {
            self.statistics.box_tests += 1;
            self.boxes.enclose(self.model, &self.hierarchy, n, q);
            self.boxes.enclose(self.model, &self.hierarchy, m, q);
            if !self.boxes.node(n).overlaps(self.boxes.node(m)) {
                return;
            }
        }
        self.statistics.opened += 1;
        match self.hierarchy.split(n, m) {
            Some(split) => {
                for (place, entry) in tree.below(place) {
                    if f64::from(entry.radius) <= self.norm {
                        let (a, b) = split.pair(entry.which());
                        self.walk.push((a, b, place));
                    }
                }
            }
            None => {
                let [x, y] = [n, m].map(|n| places(&self.hierarchy.nodes()[n as usize]));
                for i in x {
                    for j in y.clone() {
                        self.test_places((i, j), q);
                    }
                }
            }
        }
    }

    /// Two triangles, by their places in the hierarchy's order.
    fn test_places(&mut self, (i, j): (usize, usize), q: &[f64]) {
        let [a, b] = [i, j].map(|place| self.hierarchy.order()[place]);
        let relation = self.filter.relation(a, b);
        if relation == Relation::Adjacent {
            return;
        }
        let faces = self.model.mesh().faces();
        let [x, y] = [a, b].map(|t| self.boxes.moved_corners(self.model, faces[t as usize], q));
        self.statistics.box_tests += 1;
        if disjoint(&triangle_box(x), &triangle_box(y)) {
            return;
        }
        self.statistics.triangle_tests += 1;
        if self.filter.collide_as(relation, (a, b), &x, &y) {
            let pair: Pair = (a.min(b), a.max(b));
            if !self.filter.leaves_out(a, b) && !self.is_exception(pair) && !self.is_full() {
                self.pairs.push(pair);
            }
        }
    }
}

fn places(node: &Node) -> std::ops::Range<usize> {
    let first = node.first_triangle as usize;
    first..first + node.triangle_count as usize
}
