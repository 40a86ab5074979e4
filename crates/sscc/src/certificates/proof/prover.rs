//! Finds the witnesses of certificates.
//!
//! The prover repeats the computation of the bounds behind a radius: it splits nodes and subdivides triangles until
//! each part has a bound of at least the radius. The direction or the affine map of that bound is the witness.

use super::encoding::{
    DIRECTION, Header, NOTHING_COUNTS, SPLIT_FIRST, SPLIT_SECOND, TRIANGLES, put_header, put_map, put_vector,
    put_witnesses,
};
use super::entries::{ProofEntry, proof_entries};
use crate::bounds::{NodePairBounds, NodePairScratch, PairRefiner, WitnessList};
use crate::certificates::{Certificates, NodeGroups};
use crate::filter::{PairFilter, SimplexPair};
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::ScaledModel;
use crate::random::next_uniform;
use crate::{Error, Progress, ReducedModel, parallel};

/// The number of entries that a thread takes at once.
const GRAIN: usize = 4;

/// Proves certificates: finds witnesses that each entry (a node pair, or a leaf with itself, and the radius below which
/// queries skip it) is free. The entries together contain all pairs of triangles.
pub struct Prover {
    certificates: Certificates,
    scaled: ScaledModel,
    rank: usize,
    filter: PairFilter,
    nodes: NodePairBounds,
    groups: NodeGroups,
    entries: Vec<ProofEntry>,
}

impl Prover {
    /// Prepares the proof of certificates of a model.
    ///
    /// # Errors
    /// When the certificates are of another model, or have a clearance, for which there are no proofs.
    pub fn new(model: &ReducedModel, certificates: &Certificates) -> Result<Self, Error> {
        certificates.check_model(model)?;
        let parts = certificates.parts();
        if parts.scope.clearance.is_some() {
            return Err(Error::ClearanceCertificates);
        }
        let scaled = parts.scope.scaled_model(model);
        let (filter, _) = parts.scope.counted_pairs(model)?;
        Ok(Self {
            nodes: NodePairBounds::new(&scaled, &parts.hierarchy),
            groups: NodeGroups::new(&filter, &parts.hierarchy),
            entries: proof_entries(parts),
            certificates: certificates.clone(),
            rank: model.rank(),
            scaled,
            filter,
        })
    }

    /// Returns the number of entries.
    pub fn entries(&self) -> usize {
        self.entries.len()
    }

    /// Returns the numbers of `count` entries, ascending, one from each of `count` ranges of equal length; all numbers if there
    /// are fewer.
    pub fn sample(&self, count: usize, seed: u64) -> Vec<usize> {
        let (all, mut state) = (self.entries.len(), seed);
        if count >= all {
            return (0..all).collect();
        }
        let start = |i: usize| (i as u128 * all as u128 / count as u128) as usize;
        let mut within =
            |from: usize, to: usize| from + (next_uniform(&mut state) * (to - from) as f64) as usize;
        (0..count).map(|i| within(start(i), start(i + 1))).collect()
    }

    /// Returns the bytes that come before those of `proven` entries.
    pub fn header(&self, proven: usize) -> Vec<u8> {
        let (parts, mut out) = (self.certificates.parts(), Vec::new());
        let nodes = parts.hierarchy.nodes().len();
        let header =
            Header { digest: parts.digest, entries: self.entries.len(), proven, rank: self.rank, nodes };
        put_header(&mut out, &header);
        (0..nodes as u32).for_each(|n| put_map(&mut out, self.nodes.of_node(n), self.rank));
        out
    }

    /// Finds the witnesses of some entries, given by their ascending numbers, and returns the bytes.
    ///
    /// # Errors
    /// If no witness is found for an entry, its witnesses take 2^32 bytes or more, there is no entry of a number, or
    /// `progress` cancels.
    pub fn prove(
        &self,
        numbers: &[usize],
        threads: Option<usize>,
        progress: &dyn Progress,
    ) -> Result<Vec<u8>, Error> {
        let scratch = || EntryProver {
            prover: self,
            hierarchy: &self.certificates.parts().hierarchy,
            scratch: NodePairScratch::new(self.scaled.row_len),
            refiner: PairRefiner::new(&self.scaled),
            progress,
            number: 0,
            out: Vec::new(),
        };
        let prove = |prover: &mut EntryProver<'_>, number: usize| prover.prove(number);
        let numbers = numbers.iter().copied();
        let entries = parallel::on_threads(threads, || parallel::map_with(numbers, GRAIN, scratch, prove));
        Ok(entries.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
    }
}

/// Proves one entry after the other; owns the scratch memory for it.
struct EntryProver<'a> {
    prover: &'a Prover,
    hierarchy: &'a Hierarchy,
    scratch: NodePairScratch,
    refiner: PairRefiner<'a>,
    progress: &'a dyn Progress,
    /// The number of the entry.
    number: usize,
    out: Vec<u8>,
}

impl EntryProver<'_> {
    /// Returns the number of an entry, the length of its witnesses, and the witnesses, as bytes.
    fn prove(&mut self, number: usize) -> Result<Vec<u8>, Error> {
        self.number = number;
        let entry =
            self.prover.entries.get(number).ok_or_else(|| self.unproven("it does not exist".into()))?;
        self.out.clear();
        if entry.radius > 0.0 {
            self.nodes(entry.nodes, entry.radius)?;
        }
        let length = u32::try_from(self.out.len()).map_err(|_| self.unproven("it is too long".into()))?;
        let head = [&(number as u64).to_le_bytes()[..], &length.to_le_bytes()].concat();
        Ok([head, std::mem::take(&mut self.out)].concat())
    }

    fn unproven(&self, what: String) -> Error {
        Error::Unproven(format!("entry {} has no proof: {what}", self.number))
    }

    /// Appends the witnesses of two nodes, or of a leaf.
    fn nodes(&mut self, nodes: NodePair, radius: f64) -> Result<(), Error> {
        if self.progress.is_cancelled() {
            return Err(Error::Cancelled);
        }
        let Prover { scaled, filter, nodes: bounds, groups, .. } = self.prover;
        let (n, m) = nodes;
        if !groups.can_count(filter, nodes) {
            self.out.push(NOTHING_COUNTS);
            return Ok(());
        }
        if n != m
            && let Some(dir) = bounds.witness(scaled, nodes, radius, &mut self.scratch)
        {
            self.out.push(DIRECTION);
            put_vector(&mut self.out, dir);
            return Ok(());
        }
        let (node_n, node_m) = (&self.hierarchy.nodes()[n as usize], &self.hierarchy.nodes()[m as usize]);
        if node_n.is_leaf() && node_m.is_leaf() {
            return self.triangles(nodes, radius);
        }
        let is_larger = bounds.size(n) >= bounds.size(m);
        if node_m.is_leaf() || (!node_n.is_leaf() && is_larger) {
            self.out.push(SPLIT_FIRST);
            node_n.children().try_for_each(|child| self.nodes((child, m), radius))
        } else {
            self.out.push(SPLIT_SECOND);
            node_m.children().try_for_each(|child| self.nodes((n, child), radius))
        }
    }

    fn triangles(&mut self, (n, m): NodePair, radius: f64) -> Result<(), Error> {
        let filter = &self.prover.filter;
        let [x, y] = [n, m].map(|n| self.hierarchy.triangles(&self.hierarchy.nodes()[n as usize]));
        let mut list = WitnessList::default();
        for (i, &a) in x.iter().enumerate() {
            for &b in if n == m { &y[i + 1..] } else { y } {
                if filter.is_excluded(a, b) {
                    continue;
                }
                if self.progress.is_cancelled() {
                    return Err(Error::Cancelled);
                }
                for SimplexPair { a: x, b: y } in filter.simplex_pairs(a, b) {
                    if !self.refiner.prove(x, y, radius, &mut list) {
                        let what =
                            format!("no witness for triangles {a} and {b} below the radius {radius:e}");
                        return Err(self.unproven(what));
                    }
                }
            }
        }
        self.out.push(TRIANGLES);
        put_witnesses(&mut self.out, &list.witnesses, self.prover.rank);
        Ok(())
    }
}
