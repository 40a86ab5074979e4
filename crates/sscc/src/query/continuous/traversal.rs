//! Algorithm 1 of the paper on swept boxes.

use super::super::aabb::disjoint;
use super::super::{Method, Query};
use super::{Continuous, Ends};
use crate::certificates::child_pairs;
use crate::pairs::Relation;
use crate::{CertificateParts, Certificates, Error};

/// Between two looks at whether the query was cancelled.
const STEPS: u32 = 256;

impl Query<'_> {
    /// Adds all pairs that meet, exceptions apart. On the stack as in the discrete traversal: `(n, n)` stands for a node
    /// against itself, `(n, m)` for two nodes without common triangles.
    pub(super) fn traverse_swept(&mut self, state: &mut Continuous, q: Ends<'_>) -> Result<(), Error> {
        let used = self.certificates.filter(|_| self.method == Method::Certified);
        let certificates = used.map(Certificates::parts);
        self.stack.clear();
        self.stack.push((0, 0));
        let mut steps = 0_u32;
        while let Some((n, m)) = self.stack.pop() {
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) && self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            if n == m {
                self.sweep_within(state, n, q, certificates);
            } else {
                self.sweep_between(state, n, m, q);
            }
        }
        Ok(())
    }

    fn sweep_within(
        &mut self,
        state: &mut Continuous,
        n: u32,
        q: Ends<'_>,
        certificates: Option<&CertificateParts>,
    ) {
        if certificates.is_some_and(|c| self.norm < c.node_radii[n as usize]) {
            return;
        }
        self.statistics.opened += 1;
        let node = self.hierarchy.nodes()[n as usize];
        if node.is_leaf() {
            state.boxes.node(self.model, &self.hierarchy, n, q);
            let first = node.first_triangle as usize;
            for i in first..first + node.triangle_count as usize {
                for j in i + 1..first + node.triangle_count as usize {
                    self.sweep_triangles(state, i, j);
                }
            }
            return;
        }
        self.stack.extend(node.children().map(|child| (child, child)));
        // Only the root's children have certificates as pairs.
        for (pair, children) in child_pairs(&node).enumerate() {
            if n != 0 || certificates.is_none_or(|c| self.norm >= c.root_pair_radii[pair]) {
                self.stack.push(children);
            }
        }
    }

    fn sweep_between(&mut self, state: &mut Continuous, n: u32, m: u32, q: Ends<'_>) {
        self.statistics.box_tests += 1;
        let box_n = state.boxes.node(self.model, &self.hierarchy, n, q);
        let box_m = state.boxes.node(self.model, &self.hierarchy, m, q);
        if disjoint(&box_n, &box_m) {
            return;
        }
        self.statistics.opened += 1;
        let (node_n, node_m) = (self.hierarchy.nodes()[n as usize], self.hierarchy.nodes()[m as usize]);
        if node_n.is_leaf() && node_m.is_leaf() {
            let [range_n, range_m] = [node_n, node_m].map(|node| {
                node.first_triangle as usize..(node.first_triangle + node.triangle_count) as usize
            });
            for i in range_n {
                // Most triangles of a leaf stay clear of the whole other leaf.
                if disjoint(state.boxes.triangle(self.hierarchy.order()[i]), &box_m) {
                    continue;
                }
                for j in range_m.clone() {
                    self.sweep_triangles(state, i, j);
                }
            }
        } else if node_m.is_leaf() || (!node_n.is_leaf() && node_n.triangle_count >= node_m.triangle_count) {
            node_n.children().for_each(|child| self.stack.push((child, m)));
        } else {
            node_m.children().for_each(|child| self.stack.push((n, child)));
        }
    }

    /// Two triangles of open leaves, by their places in the hierarchy's order.
    #[inline]
    fn sweep_triangles(&mut self, state: &mut Continuous, i: usize, j: usize) {
        let pair = (self.hierarchy.order()[i], self.hierarchy.order()[j]);
        self.statistics.box_tests += 1;
        if disjoint(state.boxes.triangle(pair.0), state.boxes.triangle(pair.1))
            || self.filter.relation(pair.0, pair.1) == Relation::Adjacent
            || self.is_exception((pair.0.min(pair.1), pair.0.max(pair.1)))
        {
            return;
        }
        self.test_impact(state, pair);
    }
}
