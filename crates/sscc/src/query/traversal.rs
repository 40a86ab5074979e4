//! Algorithm 1 of the paper: the hierarchy against itself, with certificates where there are some.
//!
//! What is compared is always one box with up to eight at once; on the stack are pairs of nodes whose boxes overlap.

use crate::Pair;
use crate::detect::narrow_phase::Found;
use crate::detect::packet::{LANES, Lanes};
use crate::detect::search::Finder;
use crate::query::context::{Asked, Ends};

/// Between two looks at whether the query was cancelled. A step takes at most about 10 microseconds, tests of triangles
/// apart, between which it looks, too.
const STEPS: u32 = 1024;

impl<F: Found<E>, const E: usize> Finder<F, E> {
    /// Adds all that is found between two nodes, or within one; of nodes within a cluster, all of the
    /// cluster. On the stack, `(n, n)` stands for a node against itself, `(n, m)` for two nodes without common
    /// triangles.
    pub(crate) fn traverse(&mut self, asked: &Asked<'_>, (n, m): Pair, ends: &Ends<'_, E>) {
        let clusters = &self.boxes.tables.clusters;
        let start = [n, m].map(|n| clusters.of_node(n).map_or(n, |cluster| clusters.node(cluster)));
        start.iter().for_each(|n| self.boxes.enclose(*n, ends));
        self.stack.clear();
        self.stack.push(start.into());
        let mut steps = 0_u32;
        while let Some((n, m)) = self.stack.pop() {
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) {
                self.look(asked);
            }
            if self.is_full() {
                break;
            }
            if n == m { self.intra(asked, n, ends) } else { self.inter(asked, n, m, ends) }
        }
    }

    /// Lines 1 to 14: a node against itself.
    fn intra(&mut self, asked: &Asked<'_>, n: u32, ends: &Ends<'_, E>) {
        let certificates = asked.used_certificates();
        let certified = right_or!(
            certificates.is_some_and(|c| ends.norm < c.node_radii[n as usize]),
            NodeRadiusReached,
            certificates.is_some_and(|c| ends.norm <= c.node_radii[n as usize])
        );
        if certified || self.culled_by_normals(n) {
            return;
        }
        self.statistics.opened += 1;
        if let Some(cluster) = self.boxes.tables.clusters.of_node(n) {
            self.cluster_within(asked, cluster, ends);
            return;
        }
        self.boxes.open(asked, n, ends);
        let node = asked.hierarchy.nodes()[n as usize];
        self.stack.extend(node.children().map(|child| (child, child)));
        // Only the root's children have certificates as pairs.
        for (pair, (a, b)) in node.child_pairs().enumerate() {
            let is_within =
                |radius| right_or!(ends.norm < radius, RootPairRadiusReached, ends.norm <= radius);
            let certified = n == 0 && certificates.is_some_and(|c| is_within(c.root_pair_radii[pair]));
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
    fn inter(&mut self, asked: &Asked<'_>, n: u32, m: u32, ends: &Ends<'_, E>) {
        let first_child = |n: u32| asked.hierarchy.nodes()[n as usize].first_child;
        match [n, m].map(|n| self.boxes.tables.clusters.of_node(n)) {
            [Some(a), Some(b)] => self.clusters_between(asked, (a, b), ends),
            // A cluster comes second.
            [Some(_), None] => self.inter(asked, m, n, ends),
            [None, cluster] => {
                self.statistics.opened += 1;
                self.boxes.open(asked, n, ends);
                self.statistics.box_tests += LANES as u64;
                let open = self.boxes.pack(n).overlapping(self.boxes.node(m));
                if cluster.is_some() {
                    self.stack.extend(open.map(|i| (first_child(n) + i, m)));
                    return;
                }
                self.boxes.open(asked, m, ends);
                for i in open {
                    self.statistics.box_tests += LANES as u64;
                    let open = self.boxes.pack(m).overlapping_lane(self.boxes.pack(n), i as usize);
                    self.stack.extend(open.map(|j| (first_child(n) + i, first_child(m) + j)));
                }
            }
        }
    }

    /// A cluster against itself.
    pub(crate) fn cluster_within(&mut self, asked: &Asked<'_>, cluster: u32, ends: &Ends<'_, E>) {
        self.boxes.open_cluster(cluster, ends);
        for i in 0..self.boxes.tables.clusters.blocks(cluster).len() {
            self.statistics.box_tests += LANES as u64;
            let pack = self.boxes.cluster(cluster);
            let later = pack.overlapping_lane(pack, i).0 >> i << i;
            for j in Lanes(later) {
                self.blocks(asked, (cluster, i), (cluster, j as usize), ends);
            }
        }
    }

    /// Two clusters.
    pub(crate) fn clusters_between(&mut self, asked: &Asked<'_>, (a, b): Pair, ends: &Ends<'_, E>) {
        self.statistics.opened += 1;
        // The one with the lower blocks first.
        let (a, b) = (a.min(b), a.max(b));
        [a, b].iter().for_each(|cluster| self.boxes.open_cluster(*cluster, ends));
        let [x, y] = [a, b].map(|cluster| *self.boxes.node(self.boxes.tables.clusters.node(cluster)));
        self.statistics.box_tests += 1;
        if !x.overlaps(&y) {
            return;
        }
        self.statistics.box_tests += LANES as u64;
        for i in self.boxes.cluster(a).overlapping(&y) {
            self.statistics.box_tests += LANES as u64;
            for j in self.boxes.cluster(b).overlapping_lane(self.boxes.cluster(a), i as usize) {
                self.blocks(asked, (a, i as usize), (b, j as usize), ends);
            }
        }
    }

    /// Two blocks whose boxes overlap, the second not before the first (or the same); each is given by its cluster and
    /// its lane there.
    #[inline]
    fn blocks(&mut self, asked: &Asked<'_>, x: (u32, usize), y: (u32, usize), ends: &Ends<'_, E>) {
        let clusters = &self.boxes.tables.clusters;
        let [a, b] = [x, y].map(|(cluster, lane)| clusters.blocks(cluster).start + lane);
        // Most triangles of a block stay clear of the whole other block.
        let rows = self.boxes.block(a).overlapping_lane(self.boxes.cluster(y.0), y.1);
        let columns = self.boxes.block(b).overlapping_lane(self.boxes.cluster(x.0), x.1).0;
        self.statistics.box_tests += 2 * LANES as u64;
        let never = clusters.never.pairs(a, b);
        let (first_a, first_b) = (clusters.places(a).start, clusters.places(b).start);
        for row in rows {
            let open = columns & !(never >> (LANES as u32 * row)) as u32;
            if open == 0 {
                continue;
            }
            self.statistics.box_tests += LANES as u64;
            let met = self.boxes.block(b).overlapping_lane(self.boxes.block(a), row as usize).0 & open;
            for column in Lanes(met) {
                let places = [first_a + row as usize, first_b + column as usize];
                if self.boxes.are_apart((x.0, places[0]), (y.0, places[1])) {
                    continue;
                }
                let clusters = &self.boxes.tables.clusters;
                let [x, y] = places.map(|place| (clusters.triangle(place), clusters.corners()[place]));
                self.test(asked, x, y, ends);
            }
        }
    }
}
