//! Algorithm 1 of the paper: the hierarchy against itself, with certificates where there are some.
//!
//! What is compared is always one box with up to eight at once; on the stack are pairs of nodes whose boxes overlap.

use super::pack::{LANES, Lanes};
use super::{Method, Query};
use crate::certificates::child_pairs;
use crate::pairs::Relation;
use crate::{Error, Pair};

/// Between two looks at whether the query was cancelled. A step takes at most about 10 microseconds.
const STEPS: u32 = 1024;

impl Query<'_> {
    /// Appends all colliding pairs at q between two nodes, or within one; of nodes within a cluster, all of the
    /// cluster. On the stack, `(n, n)` stands for a node against itself, `(n, m)` for two nodes without common triangles.
    pub(super) fn traverse(&mut self, (n, m): Pair, q: &[f64]) -> Result<(), Error> {
        let clusters = &self.boxes.clusters;
        let start = [n, m].map(|n| clusters.of_node(n).map_or(n, |cluster| clusters.node(cluster)));
        start.iter().for_each(|n| self.boxes.enclose(self.model, &self.hierarchy, *n, q));
        self.stack.clear();
        self.stack.push(start.into());
        let mut steps = 0_u32;
        while let Some((n, m)) = self.stack.pop() {
            if self.is_full() {
                break;
            }
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) && self.progress.is_cancelled() {
                return Err(Error::Cancelled);
            }
            if n == m { self.intra(n, q) } else { self.inter(n, m, q) }
        }
        Ok(())
    }

    /// The certificates, if this method uses them.
    fn used_certificates(&self) -> Option<&crate::CertificateParts> {
        self.certificates.filter(|_| self.method == Method::Certified).map(crate::Certificates::parts)
    }

    /// Lines 1 to 14: a node against itself.
    fn intra(&mut self, n: u32, q: &[f64]) {
        if self.used_certificates().is_some_and(|c| self.norm < c.node_radii[n as usize]) {
            return;
        }
        self.statistics.opened += 1;
        self.boxes.open(self.model, &self.hierarchy, n, q);
        if let Some(cluster) = self.boxes.clusters.of_node(n) {
            let blocks = self.boxes.clusters.blocks(cluster);
            for (i, a) in blocks.clone().enumerate() {
                self.statistics.box_tests += LANES as u64;
                let later = self.boxes.pack(n).overlapping_lane(self.boxes.pack(n), i).0 >> i << i;
                for j in Lanes(later) {
                    self.blocks((n, i, a), (n, j as usize, blocks.start + j as usize));
                }
            }
            return;
        }
        let node = self.hierarchy.nodes()[n as usize];
        self.stack.extend(node.children().map(|child| (child, child)));
        // Only the root's children have certificates as pairs.
        for (pair, (a, b)) in child_pairs(&node).enumerate() {
            let certified =
                n == 0 && self.used_certificates().is_some_and(|c| self.norm < c.root_pair_radii[pair]);
            if !certified {
                self.statistics.box_tests += 1;
                let lanes = self.boxes.pack(n).overlapping(self.boxes.node(a));
                if lanes.0 >> (b - node.first_child) & 1 != 0 {
                    self.stack.push((a, b));
                }
            }
        }
    }

    /// Lines 15 to 30: two nodes against each other, whose boxes overlap. Both are opened at once.
    fn inter(&mut self, n: u32, m: u32, q: &[f64]) {
        self.statistics.opened += 1;
        self.boxes.open(self.model, &self.hierarchy, n, q);
        self.boxes.open(self.model, &self.hierarchy, m, q);
        let clusters = [n, m].map(|n| self.boxes.clusters.of_node(n));
        // A cluster comes second; of two, the one with the lower blocks first.
        let (n, m, clusters) = match clusters {
            [Some(_), None] => (m, n, [None, clusters[0]]),
            [Some(a), Some(b)] if a > b => (m, n, [Some(b), Some(a)]),
            _ => (n, m, clusters),
        };
        let first_child = |n: u32| self.hierarchy.nodes()[n as usize].first_child;
        let (first_n, first_m) = (first_child(n), first_child(m));
        self.statistics.box_tests += LANES as u64;
        for i in self.boxes.pack(n).overlapping(self.boxes.node(m)) {
            if let [None, Some(_)] = clusters {
                self.stack.push((first_n + i, m));
                continue;
            }
            self.statistics.box_tests += LANES as u64;
            for j in self.boxes.pack(m).overlapping_lane(self.boxes.pack(n), i as usize) {
                if let [Some(a), Some(b)] = clusters {
                    let [a, b] = [(a, i), (b, j)]
                        .map(|(cluster, i)| self.boxes.clusters.blocks(cluster).start + i as usize);
                    self.blocks((n, i as usize, a), (m, j as usize, b));
                } else {
                    self.stack.push((first_n + i, first_m + j));
                }
            }
        }
    }

    /// Two blocks whose boxes overlap, the second not before the first (or the same); each is given by its cluster's
    /// node, its lane there, and its number.
    #[inline]
    fn blocks(&mut self, (n, i, a): (u32, usize, usize), (m, j, b): (u32, usize, usize)) {
        // Most triangles of a block stay clear of the whole other block.
        let rows = self.boxes.block(a).overlapping_lane(self.boxes.pack(m), j);
        let columns = self.boxes.block(b).overlapping_lane(self.boxes.pack(n), i).0;
        self.statistics.box_tests += 2 * LANES as u64;
        let never = self.boxes.clusters.never.pairs(a, b);
        let (first_a, first_b) = (self.boxes.clusters.places(a).start, self.boxes.clusters.places(b).start);
        for row in rows {
            let open = columns & !(never >> (LANES as u32 * row)) as u32;
            if open == 0 {
                continue;
            }
            self.statistics.box_tests += LANES as u64;
            let met = self.boxes.block(b).overlapping_lane(self.boxes.block(a), row as usize).0 & open;
            for column in Lanes(met) {
                self.test(first_a + row as usize, first_b + column as usize);
            }
        }
    }

    /// Two triangles whose boxes overlap, by their places.
    #[inline]
    fn test(&mut self, i: usize, j: usize) {
        let [a, b] = [i, j].map(|place| self.boxes.clusters.triangle(place));
        let relation = self.filter.relation(a, b);
        if relation == Relation::Adjacent {
            return;
        }
        self.statistics.triangle_tests += 1;
        let (x, y) = (self.boxes.corners(i), self.boxes.corners(j));
        if self.filter.collide_as(relation, (a, b), &x, &y) {
            let pair = (a.min(b), a.max(b));
            if !self.filter.leaves_out(a, b) && !self.is_exception(pair) && !self.is_full() {
                self.pairs.push(pair);
            }
        }
    }
}
