//! Algorithm 1 by the certified pair tree: only pairs whose radius has been passed are looked at.

use crate::PairTree;
use crate::detect::narrow_phase::Found;
use crate::detect::search::Finder;
use crate::query::context::{Asked, Ends};

/// Between two looks at whether the query was cancelled.
const STEPS: u32 = 1024;

/// The place of a node against itself.
const NODE: u32 = u32::MAX;

/// Whether `|z|` has reached the radius of a stored pair: equality is no proof. A macro keeps the plain comparison of the
/// release build; with functions and closures here queries that open few pairs took up to 1.13 times as long.
macro_rules! is_entry_passed {
    ($entry:expr, $norm:expr) => {
        right_or!(f64::from($entry.radius) <= $norm, TreeRadiusReached, f64::from($entry.radius) < $norm)
    };
}

impl<F: Found<E>, const E: usize> Finder<F, E> {
    /// Adds all that is found, exceptions apart. On the stack, `(n, n, NODE)` stands for a node against itself, `(n, m,
    /// place)` for two nodes without common triangles; their radii have been passed.
    ///
    /// Every way down comes through one pair of clusters, or one cluster, because the larger node is split first. There
    /// the walk ends. Following it down to leaves, and moving only their vertices, was tried: where more than a few
    /// pairs of leaves are open, it takes longer than all blocks of the clusters, and where there are few, not
    /// noticeably less.
    pub(crate) fn walk_pairs(&mut self, asked: &Asked<'_>, tree: &PairTree, ends: &Ends<'_, E>) {
        self.walk.clear();
        self.walk.push((0, 0, NODE));
        let mut steps = 0_u32;
        while let Some((n, m, place)) = self.walk.pop() {
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(STEPS) {
                self.look(asked);
            }
            if self.is_full() {
                break;
            }
            if place == NODE {
                self.walk_within(asked, tree, n, ends);
            } else {
                self.walk_between(asked, tree, (n, m, place), ends);
            }
        }
    }

    /// A node against itself, whose own radius has been passed.
    fn walk_within(&mut self, asked: &Asked<'_>, tree: &PairTree, n: u32, ends: &Ends<'_, E>) {
        self.statistics.opened += 1;
        if let Some(cluster) = self.boxes.tables.clusters.of_node(n) {
            self.cluster_within(asked, cluster, ends);
            return;
        }
        let node = asked.hierarchy.nodes()[n as usize];
        let radii = asked.used_certificates().map_or(&[][..], |parts| &parts.node_radii);
        let is_open = |child: &u32| {
            let radius = radii.get(*child as usize);
            right_or!(
                radius.is_none_or(|radius| ends.norm >= *radius),
                TreeNodeRadiusReached,
                radius.is_none_or(|radius| ends.norm > *radius)
            )
        };
        self.walk.extend(node.children().filter(is_open).map(|child| (child, child, NODE)));
        let mut pairs = node.child_pairs().enumerate();
        for (place, entry) in tree.of_node(n) {
            if let Some((_, (a, b))) = pairs.find(|(which, _)| *which == entry.which() as usize)
                && is_entry_passed!(entry, ends.norm)
            {
                self.walk.push((a, b, place));
            }
        }
    }

    /// Two nodes.
    fn walk_between(
        &mut self,
        asked: &Asked<'_>,
        tree: &PairTree,
        (n, m, place): (u32, u32, u32),
        ends: &Ends<'_, E>,
    ) {
        self.statistics.box_tests += 1;
        [n, m].iter().for_each(|n| self.boxes.enclose(*n, ends));
        if !self.boxes.node(n).overlaps(self.boxes.node(m)) {
            return;
        }
        if let [Some(a), Some(b)] = [n, m].map(|n| self.boxes.tables.clusters.of_node(n)) {
            self.clusters_between(asked, (a, b), ends);
            return;
        }
        self.statistics.opened += 1;
        if let Some(split) = asked.hierarchy.split_above_buckets(n, m) {
            for (place, entry) in tree.below(place) {
                if is_entry_passed!(entry, ends.norm) {
                    let (a, b) = split.pair(entry.which());
                    self.walk.push((a, b, place));
                }
            }
        }
    }
}
