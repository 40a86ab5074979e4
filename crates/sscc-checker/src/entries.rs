//! Entries: node pairs that together contain all pairs of triangles, each with the largest radius that a query relies on.
//!
//! The traversal begins at the root and follows only the hierarchy and the pair tree, so no pair of triangles is missing: the
//! pairs within a node are those within each child and those between two children, and the pairs between two nodes are those
//! between the children of one and the other.

use crate::certificates::{Certificates, StoredPair};
use crate::refusal::{Refusal, proof};

/// Two nodes, or the same node twice, and the radius below which their pairs that count must be free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) nodes: [u32; 2],
    pub(crate) radius: f64,
}

/// Returns all entries, in the order in which proofs number them.
pub(crate) fn entries(certificates: &Certificates) -> Result<Vec<Entry>, Refusal> {
    let mut traversal = Traversal { certificates, entries: Vec::new(), visited: 0 };
    traversal.within(0, 0.0)?;
    Ok(traversal.entries)
}

struct Traversal<'a> {
    certificates: &'a Certificates,
    entries: Vec<Entry>,
    /// Stored pairs visited so far. More visits than pairs mean that links lead to the same pair twice, or form a
    /// circle.
    visited: usize,
}

impl Traversal<'_> {
    /// Adds the entries of the pairs within a node. `around`: the largest radius of the nodes that contain it.
    fn within(&mut self, n: u32, around: f64) -> Result<(), Refusal> {
        let certificates = self.certificates;
        let radius = around.max(certificates.node_radii[n as usize]);
        let node = certificates.nodes[n as usize];
        if node.children == 0 {
            self.entries.push(Entry { nodes: [n, n], radius });
            return Ok(());
        }
        for child in node.children() {
            self.within(child, radius)?;
        }
        let children = node.children();
        let pairs: Vec<[u32; 2]> =
            children.clone().flat_map(|a| (a + 1..children.end).map(move |b| [a, b])).collect();
        let of_root = |which: usize| if n == 0 { certificates.root_pair_radii[which] } else { 0.0 };
        // Without a pair tree, and within a bucket, no pairs are stored, and the limit does not apply.
        let has_pairs = certificates.pair_limit > 0.0 && !certificates.is_bucket(n);
        let stored = if has_pairs { certificates.stored_of_node(n)? } else { Vec::new() };
        let limit = if has_pairs { certificates.pair_limit } else { 0.0 };
        self.siblings(&pairs, &stored, limit, &|which| radius.max(of_root(which)))
    }

    /// Adds the entries of siblings in the pair tree: those that are stored, and the others, which are free below the limit.
    fn siblings(
        &mut self,
        pairs: &[[u32; 2]],
        stored: &[StoredPair],
        limit: f64,
        radius: &dyn Fn(usize) -> f64,
    ) -> Result<(), Refusal> {
        self.visited += stored.len();
        let is_listed = |which: u32| (which as usize) < pairs.len();
        if self.visited > self.certificates.links.len()
            || !stored.is_sorted_by(|a, b| a.which < b.which)
            || !stored.iter().all(|entry| is_listed(entry.which) && entry.radius < limit)
        {
            return proof("pair tree: an entry is listed twice, does not exist, or is not below the limit");
        }
        for (which, &nodes) in pairs.iter().enumerate() {
            match stored.iter().find(|entry| entry.which as usize == which) {
                Some(entry) => self.stored(nodes, *entry, radius(which).max(entry.radius))?,
                None => self.entries.push(Entry { nodes, radius: radius(which).max(limit) }),
            }
        }
        Ok(())
    }

    fn stored(&mut self, nodes: [u32; 2], entry: StoredPair, radius: f64) -> Result<(), Refusal> {
        match self.certificates.split(nodes) {
            None => self.entries.push(Entry { nodes, radius }),
            Some(pairs) => {
                let stored = self.certificates.stored(entry.start)?;
                self.siblings(&pairs, &stored, self.certificates.pair_limit, &|_| radius)?;
            }
        }
        Ok(())
    }
}
