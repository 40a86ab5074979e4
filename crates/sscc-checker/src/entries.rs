//! Entries: node pairs that together contain all pairs of triangles, each with the largest radius that a query relies on.
//!
//! The traversal begins at the root and follows only the hierarchy and the pair tree, so no pair of triangles is missing: the
//! pairs within a node are those within each child and those between two children, and the pairs between two nodes are those
//! between the children of one and the other.

use crate::certificates::{Certificates, StoredPair};
use crate::refusal::{Result, claim};

/// Two nodes, or the same node twice, and the radius below which their pairs that count must be free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) nodes: [u32; 2],
    pub(crate) radius: f64,
}

/// Returns all entries, in the order in which proofs number them.
pub(crate) fn entries(certificates: &Certificates) -> Result<Vec<Entry>> {
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
    fn within(&mut self, n: u32, around: f64) -> Result<()> {
        let certificates = self.certificates;
        let radius = around.max(certificates.node_radii[n as usize]);
        let children = certificates.nodes[n as usize].children();
        if children.is_empty() {
            self.entries.push(Entry { nodes: [n, n], radius });
            return Ok(());
        }
        for child in children.clone() {
            self.within(child, radius)?;
        }
        let pairs = children.clone().flat_map(|a| (a + 1..children.end).map(move |b| [a, b]));
        let of_root = |which: usize| if n == 0 { certificates.root_pair_radii[which] } else { 0.0 };
        let pair = |(which, nodes)| Entry { nodes, radius: radius.max(of_root(which)) };
        let pairs: Vec<Entry> = pairs.enumerate().map(pair).collect();
        // Without a pair tree, and within a bucket, no pairs are stored, and the limit does not apply.
        let Some(start) = certificates.start(n) else {
            self.entries.extend(pairs);
            return Ok(());
        };
        self.siblings(pairs, start)
    }

    /// Adds the entries of siblings in the pair tree, which are listed from `start`: those that are stored, and the others, which are free
    /// below the limit. `pairs`: the siblings, with the largest radius of the pairs and nodes that contain them.
    fn siblings(&mut self, pairs: Vec<Entry>, start: u32) -> Result<()> {
        let certificates = self.certificates;
        let (stored, limit) = (certificates.stored(start)?, certificates.pair_limit);
        self.visited += stored.len();
        let is_valid = |entry: &StoredPair| (entry.which as usize) < pairs.len() && entry.radius < limit;
        let are_valid = self.visited <= certificates.links.len()
            && stored.is_sorted_by(|a, b| a.which < b.which)
            && stored.iter().all(is_valid);
        claim(are_valid, "pair tree: an entry is listed twice, does not exist, or is not below the limit")?;
        for (which, Entry { nodes, radius }) in pairs.into_iter().enumerate() {
            let entry = stored.iter().find(|entry| entry.which as usize == which);
            let radius = radius.max(entry.map_or(limit, |entry| entry.radius));
            match entry.zip(certificates.split(nodes)) {
                Some((entry, parts)) => {
                    let parts = parts.into_iter().map(|nodes| Entry { nodes, radius }).collect();
                    self.siblings(parts, entry.start)?;
                }
                None => self.entries.push(Entry { nodes, radius }),
            }
        }
        Ok(())
    }
}
