//! The claims of certificates. A claim names a node or a node pair and its radius: where `|z|` is below the radius,
//! none of the triangle pairs collides, or is nearer than the clearance of the certificates if they have one.

use std::fmt;

use super::random::Random;
use crate::certificates::CertificateParts;
use crate::certificates::{StoredPair, sibling_pairs};
use crate::hierarchy::NodePair;
use crate::{Clearance, Pair};

/// The claim that no pair of triangles between two nodes, or within one node if both are the same, collides below the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    pub(super) nodes: NodePair,
    pub(super) radius: f64,
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.nodes {
            (0, 0) => f.write_str("the root"),
            (n, m) if n == m => write!(f, "node {n}"),
            (n, m) => write!(f, "the nodes {n} and {m}"),
        }
    }
}

/// All claims of certificates.
pub(super) struct Claims<'a> {
    parts: &'a CertificateParts,
    /// For each triangle its index in the hierarchy's order.
    index_in_order: Vec<u32>,
    /// The node pair of each entry of the pair tree.
    entries: Vec<NodePair>,
}

impl<'a> Claims<'a> {
    pub(super) fn new(parts: &'a CertificateParts) -> Self {
        let mut index_in_order = vec![0; parts.hierarchy.order().len()];
        for (index, a) in parts.hierarchy.order().iter().enumerate() {
            index_in_order[*a as usize] = index as u32;
        }
        // Certificates are checked when they are made: their pair tree belongs to their hierarchy.
        let entries = parts.pair_tree.pairs(&parts.hierarchy).unwrap_or_default();
        Self { parts, index_in_order, entries }
    }

    /// Returns the claim of the pairs within a node.
    pub(super) fn node(&self, n: u32) -> Claim {
        Claim { nodes: (n, n), radius: self.parts.node_radii[n as usize] }
    }

    /// Returns the claims of the pairs of the root's children, outside the pair tree.
    pub(super) fn root_pairs(&self) -> impl Iterator<Item = Claim> {
        let radii = self.parts.root_pair_radii.iter();
        self.parts.hierarchy.nodes()[0]
            .child_pairs()
            .zip(radii)
            .map(|(nodes, &radius)| Claim { nodes, radius })
    }

    /// Returns the number of entries of the pair tree.
    pub(super) fn stored_len(&self) -> usize {
        self.entries.len()
    }

    /// Returns the claim of an entry of the pair tree.
    pub(super) fn stored(&self, index: usize) -> Claim {
        Claim { nodes: self.entries[index], radius: f64::from(self.parts.pair_tree.entry(index).radius) }
    }

    /// Returns the number of nodes and node pairs below which pairs may be absent from the pair tree.
    pub(super) fn parents_len(&self) -> usize {
        if self.parts.pair_tree.limit() > 0.0 {
            self.parts.hierarchy.nodes().len() + self.entries.len()
        } else {
            0
        }
    }

    /// Returns the claims of the pairs below a node or an entry that the pair tree lacks: their radius is at least its limit.
    pub(super) fn absent(&self, parent: usize) -> Vec<Claim> {
        let (tree, hierarchy) = (&self.parts.pair_tree, &self.parts.hierarchy);
        let nodes = self.parts.hierarchy.nodes().len();
        let (all, stored): (Vec<NodePair>, Vec<u32>) = if parent < nodes {
            let stored = tree.of_node(parent as u32).map(|stored| stored.entry.which()).collect();
            (sibling_pairs(hierarchy, parent as u32).collect(), stored)
        } else {
            let (n, m) = self.entries[parent - nodes];
            let Some(split) = hierarchy.split_above_buckets(n, m) else { return Vec::new() };
            let stored = tree.below((parent - nodes) as u32).map(|stored| stored.entry.which()).collect();
            (split.pairs().collect(), stored)
        };
        let missing = (0..all.len()).filter(|which| !stored.contains(&(*which as u32)));
        missing.map(|which| Claim { nodes: all[which], radius: tree.limit() }).collect()
    }

    /// Returns a random claim of the pair tree: about an absent pair if `is_absent` and one is found, else about an
    /// entry. None if neither is found.
    pub(super) fn random_pair(&self, random: &mut Random, is_absent: bool) -> Option<Claim> {
        let tries = if is_absent && self.parents_len() > 0 { 100 } else { 0 };
        for _ in 0..tries {
            let missing = self.absent(random.below(self.parents_len()));
            if !missing.is_empty() {
                return Some(missing[random.below(missing.len())]);
            }
        }
        (!self.entries.is_empty()).then(|| self.stored(random.below(self.entries.len())))
    }

    /// Returns the claim that this triangle pair refutes, if any. The pair counts, and collides or is nearer than the
    /// clearance at a q of this norm.
    fn refuted_by(&self, faces: Pair, norm: f64) -> Option<Claim> {
        let (hierarchy, tree) = (&self.parts.hierarchy, &self.parts.pair_tree);
        let nodes = hierarchy.nodes();
        let [index_a, index_b] = [faces.0, faces.1].map(|a| self.index_in_order[a as usize]);
        let has = |n: u32, index: u32| {
            let node = &nodes[n as usize];
            (node.first_triangle..node.first_triangle + node.triangle_count).contains(&index)
        };
        let is_refuted = |claim: &Claim| norm < claim.radius;
        // Descends to the smallest node that contains both.
        let mut n = 0;
        let (child_a, child_b) = loop {
            if let Some(claim) = Some(self.node(n)).filter(is_refuted) {
                return Some(claim);
            }
            let child = |index| nodes[n as usize].children().find(|child| has(*child, index));
            match (child(index_a), child(index_b)) {
                (Some(a), Some(b)) if a == b => n = a,
                (Some(a), Some(b)) => break (a.min(b), a.max(b)),
                _ => return None,
            }
        };
        let of_root = self.root_pairs().find(|claim| n == 0 && claim.nodes == (child_a, child_b));
        if let Some(claim) = of_root.filter(is_refuted) {
            return Some(claim);
        }
        if tree.limit() <= 0.0 || hierarchy.is_bucket_below_root(n) {
            return None;
        }
        // From there, descends through the node pairs that contain one of the triangles in each node.
        let mut pair = (child_a, child_b);
        let mut siblings: Vec<_> = {
            let all: Vec<NodePair> = nodes[n as usize].child_pairs().collect();
            tree.of_node(n).map(|StoredPair { index, entry }| (index, all[entry.which() as usize])).collect()
        };
        loop {
            let Some(&(index, _)) = siblings.iter().find(|(_, nodes)| *nodes == pair) else {
                return Some(Claim { nodes: pair, radius: tree.limit() }).filter(is_refuted);
            };
            if let Some(claim) = Some(self.stored(index as usize)).filter(is_refuted) {
                return Some(claim);
            }
            let split = hierarchy.split_above_buckets(pair.0, pair.1)?;
            let contains_both =
                |&(n, m): &NodePair| has(n, index_a) && has(m, index_b) || has(n, index_b) && has(m, index_a);
            pair = split.pairs().find(contains_both)?;
            let pair_of = |StoredPair { index, entry }| (index, split.pair(entry.which()));
            siblings = tree.below(index).map(pair_of).collect();
        }
    }

    /// Returns a violation if two triangles refute a claim. They count, and collide or are nearer than the clearance at
    /// q.
    pub(super) fn violation(&self, faces: Pair, norm: f64, q: &[f64]) -> Option<String> {
        let claim = self.refuted_by(faces, norm)?;
        let found = self.parts.scope.clearance.map_or_else(
            || "collide".to_owned(),
            |clearance: Clearance| format!("are nearer than {:e}", clearance.distance()),
        );
        Some(format!(
            "triangles {} and {} {found} at |z| = {norm:e}, below the radius {:e} of {claim}; q = {q:?}",
            faces.0, faces.1, claim.radius
        ))
    }
}
