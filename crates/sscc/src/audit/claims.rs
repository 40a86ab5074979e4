//! What certificates claim of a pair of triangles: every radius of a set of pairs to which it belongs.

use std::fmt;

use super::random::Random;
use crate::certificates::{StoredPair, sibling_pairs};
use crate::{CertificateParts, Pair};

/// No pair of triangles between two nodes, or within one where both are the same, collides below the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    pub(super) nodes: Pair,
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
    /// Where each triangle is in the hierarchy's order.
    places: Vec<u32>,
    /// The nodes of each entry of the pair tree.
    entries: Vec<Pair>,
}

impl<'a> Claims<'a> {
    pub(super) fn new(parts: &'a CertificateParts) -> Self {
        let mut places = vec![0; parts.hierarchy.order().len()];
        for (place, t) in parts.hierarchy.order().iter().enumerate() {
            places[*t as usize] = place as u32;
        }
        // Certificates hold no other trees than those over their hierarchy.
        let entries = parts.pair_tree.pairs(&parts.hierarchy).unwrap_or_default();
        Self { parts, places, entries }
    }

    /// What is claimed of a node against itself.
    pub(super) fn node(&self, n: u32) -> Claim {
        Claim { nodes: (n, n), radius: self.parts.node_radii[n as usize] }
    }

    /// What is claimed of the pairs of the root's children beside the pair tree.
    pub(super) fn root_pairs(&self) -> impl Iterator<Item = Claim> {
        let radii = self.parts.root_pair_radii.iter();
        self.parts.hierarchy.nodes()[0]
            .child_pairs()
            .zip(radii)
            .map(|(nodes, &radius)| Claim { nodes, radius })
    }

    /// How many pairs of nodes the pair tree holds.
    pub(super) fn stored_len(&self) -> usize {
        self.entries.len()
    }

    /// What the pair tree claims by the entry of that place.
    pub(super) fn stored(&self, place: usize) -> Claim {
        Claim { nodes: self.entries[place], radius: f64::from(self.parts.pair_tree.entry(place).radius) }
    }

    /// How many nodes and pairs of nodes there are below which pairs may be missing.
    pub(super) fn parents_len(&self) -> usize {
        if self.parts.pair_tree.limit() > 0.0 {
            self.parts.hierarchy.nodes().len() + self.entries.len()
        } else {
            0
        }
    }

    /// What the pair tree claims by what it does not hold: the missing pairs below a node or an entry.
    pub(super) fn absent(&self, parent: usize) -> Vec<Claim> {
        let (tree, hierarchy) = (&self.parts.pair_tree, &self.parts.hierarchy);
        let nodes = self.parts.hierarchy.nodes().len();
        let (all, stored): (Vec<Pair>, Vec<u32>) = if parent < nodes {
            let stored = tree.of_node(parent as u32).map(|stored| stored.entry.which()).collect();
            (sibling_pairs(hierarchy, parent as u32).collect(), stored)
        } else {
            let (n, m) = self.entries[parent - nodes];
            let Some(split) = hierarchy.split_large(n, m) else { return Vec::new() };
            let stored = tree.below((parent - nodes) as u32).map(|stored| stored.entry.which()).collect();
            (split.pairs().collect(), stored)
        };
        let missing = (0..all.len()).filter(|which| !stored.contains(&(*which as u32)));
        missing.map(|which| Claim { nodes: all[which], radius: tree.limit() }).collect()
    }

    /// A claim of the pair tree, by what it holds or by what it does not; none where it holds nothing.
    pub(super) fn random_pair(&self, random: &mut Random, of_absent: bool) -> Option<Claim> {
        if self.entries.is_empty() {
            return None;
        }
        for _ in 0..if of_absent { 100 } else { 0 } {
            let missing = self.absent(random.below(self.parents_len()));
            if !missing.is_empty() {
                return Some(missing[random.below(missing.len())]);
            }
        }
        Some(self.stored(random.below(self.entries.len())))
    }

    /// The claim that is broken by two triangles that count and collide at a q of that norm, if any is.
    pub(super) fn broken_by(&self, faces: Pair, norm: f64) -> Option<Claim> {
        let (hierarchy, tree) = (&self.parts.hierarchy, &self.parts.pair_tree);
        let nodes = hierarchy.nodes();
        let [i, j] = [faces.0, faces.1].map(|t| self.places[t as usize]);
        let has = |n: u32, place: u32| {
            let node = &nodes[n as usize];
            (node.first_triangle..node.first_triangle + node.triangle_count).contains(&place)
        };
        let is_broken = |claim: &Claim| norm < claim.radius;
        // Down to the last node that holds both.
        let mut n = 0;
        let (a, b) = loop {
            if let Some(claim) = Some(self.node(n)).filter(is_broken) {
                return Some(claim);
            }
            let child = |place| nodes[n as usize].children().find(|child| has(*child, place));
            match (child(i), child(j)) {
                (Some(a), Some(b)) if a == b => n = a,
                (Some(a), Some(b)) => break (a.min(b), a.max(b)),
                _ => return None,
            }
        };
        let of_root = self.root_pairs().find(|claim| n == 0 && claim.nodes == (a, b));
        if let Some(claim) = of_root.filter(is_broken) {
            return Some(claim);
        }
        if tree.limit() <= 0.0 || hierarchy.is_whole(n) {
            return None;
        }
        // And from there down the pairs of nodes that hold one each.
        let mut pair = (a, b);
        let mut siblings: Vec<_> = {
            let all: Vec<Pair> = nodes[n as usize].child_pairs().collect();
            tree.of_node(n).map(|StoredPair { place, entry }| (place, all[entry.which() as usize])).collect()
        };
        loop {
            let Some(&(place, _)) = siblings.iter().find(|(_, nodes)| *nodes == pair) else {
                return Some(Claim { nodes: pair, radius: tree.limit() }).filter(is_broken);
            };
            if let Some(claim) = Some(self.stored(place as usize)).filter(is_broken) {
                return Some(claim);
            }
            let split = hierarchy.split_large(pair.0, pair.1)?;
            let holds = |&(n, m): &Pair| has(n, i) && has(m, j) || has(n, j) && has(m, i);
            pair = split.pairs().find(holds)?;
            let pair_of = |StoredPair { place, entry }| (place, split.pair(entry.which()));
            siblings = tree.below(place).map(pair_of).collect();
        }
    }

    /// The violation by two triangles that count and collide at q, if there is one.
    pub(super) fn violation(&self, faces: Pair, norm: f64, q: &[f64]) -> Option<String> {
        let claim = self.broken_by(faces, norm)?;
        Some(format!(
            "triangles {} and {} collide at |z| = {norm:e}, below the radius {:e} of {claim}; q = {q:?}",
            faces.0, faces.1, claim.radius
        ))
    }
}
