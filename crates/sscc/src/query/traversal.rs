//! Algorithm 1 of the paper: the hierarchy against itself, with certificates where there are some.

use super::boxes::disjoint;
use super::{Method, Query};
use crate::certificates::child_pairs;
use crate::pairs::Relation;
use crate::{Error, Pair, PairTree};

/// The place of a pair of nodes that the pair tree does not hold.
const NOWHERE: u32 = u32::MAX;

/// Between two looks at whether the query was cancelled. A step takes at most about 10 microseconds.
const STEPS: u32 = 1024;

impl<'a> Query<'a> {
    /// Appends all colliding pairs at q between the nodes of `start`. On the stack, `(n, n)` stands for a node
    /// against itself, `(n, m)` for two nodes without common triangles, with their place in the pair tree.
    pub(super) fn traverse(&mut self, start: Pair, q: &[f64]) -> Result<(), Error> {
        self.stack.clear();
        self.stack.push((start.0, start.1, NOWHERE));
        let mut steps = 0_u32;
        while let Some((n, m, place)) = self.stack.pop() {
            if self.is_full() {
                break;
            }
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) && self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            if n == m { self.intra(n, q) } else { self.inter(n, m, place, q) }
        }
        Ok(())
    }

    /// The certificates, if this method uses them.
    fn used_certificates(&self) -> Option<&crate::CertificateParts> {
        self.certificates.filter(|_| self.method == Method::Certified).map(crate::Certificates::parts)
    }

    /// The pair tree, if this method uses it and it is complete for this norm.
    fn pair_tree(&self) -> Option<&'a PairTree> {
        let tree = self.certificates.filter(|_| self.method == Method::Certified).map(|c| &c.parts().pair_tree)?;
        (self.norm < tree.limit()).then_some(tree)
    }

    /// Lines 1 to 14: a node against itself.
    fn intra(&mut self, n: u32, q: &[f64]) {
        if self.used_certificates().is_some_and(|c| self.norm < c.node_radii[n as usize]) {
            return;
        }
        self.statistics.opened += 1;
        let node = self.hierarchy.nodes()[n as usize];
        if node.is_leaf() {
            self.boxes.node(self.model, &self.hierarchy, n, q);
            let first = node.first_triangle as usize;
            for i in first..first + node.triangle_count as usize {
                for j in i + 1..first + node.triangle_count as usize {
                    self.test(i, j);
                }
            }
            return;
        }
        self.stack.extend(node.children().map(|child| (child, child, NOWHERE)));
        if let Some(tree) = self.pair_tree() {
            let pairs: [Option<Pair>; 6] = std::array::from_fn({
                let mut pairs = child_pairs(&node);
                move |_| pairs.next()
            });
            for (place, entry) in tree.of_node(n) {
                if f64::from(entry.radius) <= self.norm
                    && let Some((a, b)) = pairs[entry.which() as usize]
                {
                    self.stack.push((a, b, place));
                }
            }
            return;
        }
        // Only the root's children have certificates as pairs.
        for (pair, (a, b)) in child_pairs(&node).enumerate() {
            let certified =
                n == 0 && self.used_certificates().is_some_and(|c| self.norm < c.root_pair_radii[pair]);
            if !certified {
                self.stack.push((a, b, NOWHERE));
            }
        }
    }

    /// Lines 15 to 30: two nodes against each other.
    fn inter(&mut self, n: u32, m: u32, place: u32, q: &[f64]) {
        self.statistics.box_tests += 1;
        let box_n = self.boxes.node(self.model, &self.hierarchy, n, q);
        let box_m = self.boxes.node(self.model, &self.hierarchy, m, q);
        if disjoint(&box_n, &box_m) {
            return;
        }
        self.statistics.opened += 1;
        let Some(split) = self.hierarchy.split(n, m) else {
            let (node_n, node_m) = (self.hierarchy.nodes()[n as usize], self.hierarchy.nodes()[m as usize]);
            let first = node_m.first_triangle as usize;
            for i in node_n.first_triangle as usize..(node_n.first_triangle + node_n.triangle_count) as usize
            {
                // Most triangles of a leaf stay clear of the whole other leaf.
                let t = self.hierarchy.order()[i];
                if disjoint(self.boxes.triangle(t), &box_m) {
                    continue;
                }
                for j in first..first + node_m.triangle_count as usize {
                    self.test(i, j);
                }
            }
            return;
        };
        if place == NOWHERE {
            self.stack.extend(split.pairs().map(|(a, b)| (a, b, NOWHERE)));
        } else if let Some(tree) = self.pair_tree() {
            for (place, entry) in tree.below(place) {
                if f64::from(entry.radius) <= self.norm {
                    let (a, b) = split.pair(entry.which());
                    self.stack.push((a, b, place));
                }
            }
        }
    }

    /// Two triangles of open leaves, by their places in the hierarchy's order.
    #[inline]
    fn test(&mut self, i: usize, j: usize) {
        let (a, b) = (self.hierarchy.order()[i], self.hierarchy.order()[j]);
        self.statistics.box_tests += 1;
        if disjoint(self.boxes.triangle(a), self.boxes.triangle(b)) {
            return;
        }
        let relation = self.filter.relation(a, b);
        if relation == Relation::Adjacent {
            return;
        }
        self.statistics.triangle_tests += 1;
        let faces = self.model.mesh().faces();
        let (x, y) = (self.boxes.corners(faces[a as usize]), self.boxes.corners(faces[b as usize]));
        if self.filter.collide_as(relation, (a, b), &x, &y) {
            let pair = (a.min(b), a.max(b));
            if !self.filter.leaves_out(a, b) && !self.is_exception(pair) && !self.is_full() {
                self.pairs.push(pair);
            }
        }
    }
}
