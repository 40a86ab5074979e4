//! Entries: node pairs that together contain all pairs of triangles, each with the largest radius that a query relies on.

use crate::certificates::CertificateParts;
use crate::certificates::pair_tree::{StoredPair, sibling_pairs};
use crate::hierarchy::{Hierarchy, NodePair};

/// A node pair (or a leaf with itself), and the radius below which its pairs are certified.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ProofEntry {
    pub(super) nodes: NodePair,
    pub(super) radius: f64,
}

/// Returns all entries, in the order of their numbers.
pub(super) fn proof_entries(parts: &CertificateParts) -> Vec<ProofEntry> {
    let mut traversal = Traversal { parts, hierarchy: &parts.hierarchy, entries: Vec::new() };
    traversal.within(0, 0.0);
    traversal.entries
}

struct Traversal<'a> {
    parts: &'a CertificateParts,
    hierarchy: &'a Hierarchy,
    entries: Vec<ProofEntry>,
}

impl Traversal<'_> {
    fn within(&mut self, n: u32, around: f64) {
        let parts = self.parts;
        let radius = around.max(parts.node_radii[n as usize]);
        let node = self.hierarchy.nodes()[n as usize];
        if node.is_leaf() {
            self.entries.push(ProofEntry { nodes: (n, n), radius });
            return;
        }
        node.children().for_each(|child| self.within(child, radius));
        let of_root = |which: usize| if n == 0 { parts.root_pair_radii[which] } else { 0.0 };
        let tree = &parts.pair_tree;
        if tree.limit() > 0.0 && !self.hierarchy.is_bucket_below_root(n) {
            let pairs: Vec<NodePair> = sibling_pairs(self.hierarchy, n).collect();
            let stored: Vec<StoredPair> = tree.of_node(n).collect();
            self.siblings(&pairs, &stored, &|which| radius.max(of_root(which)));
            return;
        }
        let pairs = node.child_pairs().enumerate();
        self.entries
            .extend(pairs.map(|(which, nodes)| ProofEntry { nodes, radius: radius.max(of_root(which)) }));
    }

    /// Adds the entries of siblings: those that are stored, and the others, which are certified below the limit.
    fn siblings(&mut self, pairs: &[NodePair], stored: &[StoredPair], radius: &dyn Fn(usize) -> f64) {
        let tree = &self.parts.pair_tree;
        for (which, &nodes) in pairs.iter().enumerate() {
            let found = stored.iter().find(|pair| pair.entry.which() as usize == which);
            let Some(StoredPair { index, entry }) = found.copied() else {
                self.entries.push(ProofEntry { nodes, radius: radius(which).max(tree.limit()) });
                continue;
            };
            let radius = radius(which).max(f64::from(entry.radius));
            match self.hierarchy.split_above_buckets(nodes.0, nodes.1) {
                None => self.entries.push(ProofEntry { nodes, radius }),
                Some(split) => {
                    let (children, below): (Vec<NodePair>, Vec<StoredPair>) =
                        (split.pairs().collect(), tree.below(index).collect());
                    self.siblings(&children, &below, &|_| radius);
                }
            }
        }
    }
}
