//! The local certificates that hold in one search.
//!
//! If `|z|` is large enough (`QueryContext::local_norm`), a search evaluates the root's certificate first. If that does
//! not hold, and the search has done some work, it evaluates the certificates of other nodes from the root down, and
//! stops at the nodes whose certificate holds: these are *proven*. From then on the traversal skips proven nodes, and
//! pairs of nodes that a certificate proves.

use super::local_inequality::LocalInequality;
use super::local_tables::LocalTables;
use crate::certificates::LocalCertificates;
use crate::detect::vertex_motion::VertexMotion;
use crate::hierarchy::{Hierarchy, NodePair};

/// A search stops evaluating certificates from the root down once it has evaluated more than the sum of [`MOST_LOST`], one for this
/// many buckets, and one for each proven bucket. Only the time of queries depends on that.
const BUCKETS_OF_EVALUATION: usize = 16;

/// Certificates that a search may always evaluate, also if none of them holds.
const MOST_LOST: usize = 32;

/// Certificates are evaluated for pairs of nodes if they prove at least one of this many buckets for which they were evaluated.
const LEAST_SHARE: usize = 3;

/// Most buckets count as open if more than one of this many is. Only the time of queries depends on that.
const MOST_OPEN: usize = 2;

/// Work of a search, in visits and packets of AABBs, after which it finds proven nodes: at least this, and at least one for
/// [`BUCKETS_OF_WORK`] buckets. Finding them takes about twice as long, and longer in large shapes, so short searches end before it
/// would pay. It does not depend on earlier searches, so that one q always gives the same statistics.
const WORK_BEFORE: u64 = 192;
const BUCKETS_OF_WORK: u64 = 4;

/// The number of AABBs that are compared at once.
const PACKET: u64 = crate::vectors::LANES as u64;

/// Returns the work of a search, from its numbers of visits and of tests of AABBs.
#[inline]
pub(super) fn work(visits: u64, box_tests: u64) -> u64 {
    visits + box_tests / PACKET
}

/// The local certificates that hold in one search.
#[derive(Clone)]
pub(super) struct LocalProofs<const E: usize> {
    inequality: LocalInequality<E>,
    search: u32,
    /// For each certificate the search in which it was evaluated last, and the bound below which it allowed ratios.
    allowed: Vec<(u32, f32)>,
    /// For each bucket, by its position, the search in which it was proven last, and the node whose certificate proved it.
    proven: Vec<(u32, u32)>,
    stack: Vec<u32>,
    is_usable: bool,
    /// See [`WORK_BEFORE`].
    work_before: u64,
    /// Whether this search finds no more proven nodes.
    is_complete: bool,
    /// The number of certificates that the search evaluated from the root down.
    evaluated: usize,
    /// The number of buckets that these certificates proved.
    proven_buckets: usize,
    /// The number of open buckets.
    open_buckets: usize,
}

impl<const E: usize> LocalProofs<E> {
    pub(super) fn new(tables: &LocalTables) -> Self {
        Self {
            inequality: LocalInequality::new(),
            // The marks below have the number 0, which is that of no search.
            search: 1,
            allowed: vec![(0, 0.0); tables.certificates.nodes.len()],
            proven: vec![(0, 0); tables.buckets[0].end as usize],
            stack: Vec::new(),
            is_usable: false,
            work_before: WORK_BEFORE.max(u64::from(tables.buckets[0].end) / BUCKETS_OF_WORK),
            is_complete: false,
            evaluated: 0,
            proven_buckets: 0,
            open_buckets: 0,
        }
    }

    /// Whether the certificate of the root proves it.
    pub(super) fn prove_root(&mut self, tables: &LocalTables) -> bool {
        let Some(index) = tables.certificate_of(0) else { return false };
        let (ratio, allowed) =
            (tables.certificates.bounds[index].ratio, f64::from(self.allowed(tables, index)));
        // Allowed ratios are rounded down ([`LocalInequality::allowed`]), so that equality would be a proof, too. They are never infinite.
        with_mutant!(ratio < allowed, LocalRatioReached, ratio <= allowed)
    }

    /// Returns the work, as [`work`] counts it, after which this search finds proven nodes; `u64::MAX` if it has found them, or cannot.
    pub(super) fn work_before(&self) -> u64 {
        if self.is_usable && !self.is_complete { self.work_before } else { u64::MAX }
    }

    /// Whether [`Self::prove`] has found the proven nodes of this search.
    pub(super) fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// Whether most buckets are open after [`Self::prove`]. Those whose certificates it did not evaluate count as open. Most are open far
    /// from rest, where AABBs of the BD-tree are loose.
    pub(super) fn leaves_most_open(&self) -> bool {
        self.open_buckets * MOST_OPEN > self.proven.len()
    }

    /// Finds proven nodes from the root down, once in a search, among those whose radius is reached at a norm. If few
    /// of the buckets that it reaches are proven, the search evaluates no certificates of pairs: few pairs of the other
    /// buckets would be proven, and each evaluation takes time.
    pub(super) fn prove(
        &mut self,
        tables: &LocalTables,
        hierarchy: &Hierarchy,
        node_radii: &[f64],
        norm: f64,
    ) {
        let is_open = |n: u32| node_radii[n as usize] <= norm;
        if !self.is_usable || self.is_complete {
            return;
        }
        let most_lost = MOST_LOST + self.proven.len() / BUCKETS_OF_EVALUATION;
        while self.evaluated <= most_lost + self.proven_buckets
            && let Some(n) = self.stack.pop()
        {
            if let Some(index) = tables.certificate_of(n) {
                self.evaluated += 1;
                let allowed = self.allowed(tables, index);
                if tables.certificates.bounds[index].ratio < f64::from(allowed) {
                    let range = &tables.buckets[n as usize];
                    self.proven[range.start as usize..range.end as usize].fill((self.search, n));
                    self.proven_buckets += range.len();
                    continue;
                }
            }
            let node = &hierarchy.nodes()[n as usize];
            if node.fits_in_bucket() {
                self.open_buckets += 1;
            } else {
                self.stack.extend(node.children().filter(|child| is_open(*child)));
            }
        }
        self.is_complete = true;
        self.is_usable = self.proven_buckets * LEAST_SHARE >= self.proven_buckets + self.open_buckets;
        self.open_buckets += self.stack.iter().map(|n| tables.buckets[*n as usize].len()).sum::<usize>();
    }

    /// Returns the pairs of nodes that one certificate proves free during a motion: its node with itself, and with nodes of its list.
    /// It begins a new search.
    pub(super) fn claims<M: VertexMotion<E>>(
        &mut self,
        tables: &LocalTables,
        motion: &M,
        index: usize,
    ) -> Vec<NodePair> {
        if !self.begin(tables, motion) {
            return Vec::new();
        }
        let allowed = self.allowed(tables, index);
        let LocalCertificates { nodes, bounds, list_starts, list_nodes, list_ratios, .. } =
            &*tables.certificates;
        let range = list_starts[index] as usize..list_starts[index + 1] as usize;
        let own = (bounds[index].ratio < f64::from(allowed)).then_some(nodes[index]);
        let of_list = list_nodes[range.clone()].iter().zip(&list_ratios[range]);
        let others = of_list.filter(|(_, ratio)| **ratio < allowed).map(|(m, _)| *m);
        own.into_iter().chain(others).map(|m| (nodes[index], m)).collect()
    }

    /// Begins a new search, without the proofs of the last one. False if certificates prove nothing about the motion.
    pub(super) fn begin<M: VertexMotion<E>>(&mut self, tables: &LocalTables, motion: &M) -> bool {
        self.search = with_mutant!(self.search.wrapping_add(1), LocalProofsKept, self.search);
        if with_mutant!(self.search == 0, LocalSearchesWrap, false) {
            self.proven.fill((0, 0));
            self.allowed.fill((0, 0.0));
            self.search = 1;
        }
        (self.evaluated, self.proven_buckets, self.open_buckets) = (0, 0, 0);
        self.is_complete = false;
        self.stack.clear();
        self.stack.push(0);
        self.is_usable = self.inequality.set_motion(tables, motion);
        self.is_usable
    }

    /// Whether a certificate proves that no two triangles of a node collide.
    #[inline]
    pub(super) fn is_node_proven(&self, tables: &LocalTables, n: u32) -> bool {
        self.proven_node(tables, n).is_some()
    }

    /// Returns the node whose certificate proves a node.
    #[inline]
    fn proven_node(&self, tables: &LocalTables, n: u32) -> Option<u32> {
        let range = &tables.buckets[n as usize];
        let (search, by) = self.proven[range.start as usize];
        let is_within = tables.buckets[by as usize].end >= range.end;
        (search == self.search && with_mutant!(is_within, LocalProofOfOnePart, true)).then_some(by)
    }

    /// Whether the certificate that proves one of two nodes also proves that no triangle of one collides with one of the other. A
    /// certificate that does not prove its node proves no pair either: the ratios of its list are at least that of its node.
    #[inline]
    pub(super) fn is_pair_proven(&mut self, tables: &LocalTables, (n, m): (u32, u32)) -> bool {
        if !(self.is_usable && self.is_complete) {
            return false;
        }
        // A certificate proves nothing about two nodes of its list.
        let of_one_list = with_mutant!(
            false,
            LocalRingWithRing,
            (0..tables.certificates.nodes.len()).any(|index| {
                let allowed = self.allowed(tables, index);
                [n, m].iter().all(|n| tables.ratio_with(index, *n).is_some_and(|ratio| ratio < allowed))
            })
        );
        if of_one_list {
            return true;
        }
        for (n, m) in [(n, m), (m, n)] {
            if let Some(by) = self.proven_node(tables, n)
                && let Some(index) = tables.certificate_of(by)
                && let Some(ratio) = tables.ratio_with(index, m)
                && ratio < self.allowed(tables, index)
            {
                return true;
            }
        }
        false
    }

    /// Returns the bound below which a certificate allows ratios.
    #[inline]
    fn allowed(&mut self, tables: &LocalTables, index: usize) -> f32 {
        let (search, allowed) = self.allowed[index];
        if search == self.search {
            return allowed;
        }
        let allowed = self.inequality.allowed(tables, index);
        self.allowed[index] = (self.search, allowed);
        allowed
    }
}

#[cfg(test)]
mod tests;
